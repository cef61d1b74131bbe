"""Recordings that others made, read without guessing: CSV, bags, units."""

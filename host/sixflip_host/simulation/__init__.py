"""Captures made by arrays from a scenario, and how true they are to real recordings."""

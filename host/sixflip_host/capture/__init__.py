"""Captures and what is said of them: read, write, import, export, show, apply."""

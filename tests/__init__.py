"""The tests, the programs of their studies, and what both share (worlds, faults)."""

"""A board without hardware on MicroPython's unix port, and the demo that runs on it."""

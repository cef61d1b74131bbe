"""The gap between a nominal simulated sensor and a real one: where it lies, what makes it."""

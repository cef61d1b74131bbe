"""Everything in a capture in one least squares: what a board has no room for."""

"""A capture solved on the host: the board's arithmetic, and an independent one in numpy."""

"""A capture solved in numpy and refined, and the board held against it."""

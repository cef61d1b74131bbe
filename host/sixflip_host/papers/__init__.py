"""The printed tables of the two seed papers, computed again."""

"""Many boards of one kind: what their batch shares, told from what a single one has."""

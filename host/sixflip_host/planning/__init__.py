"""What a protocol can tell apart and detect, and which poses to add."""

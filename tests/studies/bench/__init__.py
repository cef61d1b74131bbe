"""Speeds, sizes and accuracies: every figure of the README and of the documents."""

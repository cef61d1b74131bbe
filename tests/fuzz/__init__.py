"""Readers of bytes that somebody else wrote, fuzzed from a corpus."""

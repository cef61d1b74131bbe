"""Scenarios that several tests and studies play: sessions, boards, parts and their recordings."""

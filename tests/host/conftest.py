"""Fixtures of the tests on a virtual board."""

from micropython_tier import board, link, micropython

__all__ = ["board", "link", "micropython"]

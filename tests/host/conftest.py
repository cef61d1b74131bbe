"""Fixtures of the tests on a virtual board."""

from tests.worlds.micropython_tier import board, link, micropython, provisioned

__all__ = ["board", "link", "micropython", "provisioned"]

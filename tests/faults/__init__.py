"""Buses, cables and boards that fail, what becomes of a calibration over them, and the tests."""

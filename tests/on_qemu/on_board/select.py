"""The port has no select: boards/machine_board.py imports it, and nobody reads lines here."""

"""The port has no time: boards/board.py imports it, and the boards here bring their own clock."""

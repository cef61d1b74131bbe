"""The diagnosis on sealed cases of an independent generator: `make blind`."""

"""What became of every board: its calibrations and checks, kept on this computer."""

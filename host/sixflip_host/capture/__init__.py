"""What a sensor recorded: labels, rows, rests and poses found in them, files read and written."""

"""What is wrong between this computer, the board and the sensor, and what to do about it."""

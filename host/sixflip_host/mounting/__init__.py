"""How the sensor sits in the robot: roll, pitch and the robot's own axes."""

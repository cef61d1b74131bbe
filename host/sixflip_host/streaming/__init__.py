"""A board's corrected samples for other programs, live: ROS 2 over DDS, and Foxglove."""

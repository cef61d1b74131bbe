"""What others read: tables, C, bags, and the noise of a sensor for other simulators."""

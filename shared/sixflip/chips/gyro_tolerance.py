"""By how much a chip's gyro scale may be off out of the factory, a part of one at 25 °C.

MPU-6000/6050 Product Specification rev. 3.4, table 6.1 (sensitivity scale factor tolerance);
ITG-3205 datasheet PS-ITG-3205A-00 rev. 1.0, table 3.1. None stands for a chip unknown to us.
"""

GYRO_SCALE = {"mpu6050": 0.03, "gy85": 0.06, "itg3205": 0.06}

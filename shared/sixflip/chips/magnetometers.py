"""Magnetometers of a GY-85: recognised and named, not used yet.

Many boards sold with an HMC5883L carry a QMC5883L: another address, other registers.
Sources: Honeywell HMC5883L datasheet rev. E, QST QMC5883L datasheet rev. 1.0.
"""

# (name, address, first of the identification's registers, what it reads)
KNOWN = (("HMC5883L", 0x1E, 0x0A, b"H43"),
         ("QMC5883L", 0x0D, 0x0D, b"\xff"))

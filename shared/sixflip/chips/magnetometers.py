"""Magnetometers of a GY-85: recognised and named, not used yet.

Many boards sold with an HMC5883L carry a QMC5883L: another address, other registers.
Sources: Honeywell HMC5883L datasheet rev. E, QST QMC5883L datasheet rev. 1.0.
"""

try:
    from micropython import const
except ImportError:
    def const(value):
        return value

HMC5883L_ADDRESS = const(0x1E)
HMC5883L_ID = const(0x0A)       # three registers: b"H43"
HMC5883L_IDENTIFICATION = b"H43"
QMC5883L_ADDRESS = const(0x0D)
QMC5883L_CHIP_ID = const(0x0D)
QMC5883L_IDENTIFICATION = b"\xff"

# (name, address, id register, expected bytes)
KNOWN = (("HMC5883L", HMC5883L_ADDRESS, HMC5883L_ID, HMC5883L_IDENTIFICATION),
         ("QMC5883L", QMC5883L_ADDRESS, QMC5883L_CHIP_ID, QMC5883L_IDENTIFICATION))

"""What an effect may depend on: the true state of the sensor at one moment, or at many.

Every field is a float on the board and may be a numpy array (n,) on the host; triples are
tuples of three of them in the sensor's own axes.
"""
import math

from sixflip_sim import noise


class Moment:
    """t            s since power-up
    temperature  degC of the chip, temperature_rate its degC/s
    f            specific force in g, (x, y, z)
    w            angular rate in deg/s; w_rate its deg/s2
    up           unit vector against gravity, table_x and table_y the table's axes, in the sensor
    before       f of the pose before this one (its own at the first)
    since_move   s since the last move ended
    face         0..5 of shared/sixflip/poses/faces.py, -1 elsewhere
    session      number of the session, 0 the first
    volts        of the supply; vibration_mg: rms of what shakes the sensor
    exp, sin, floor, gauss   the functions that fit the fields: math's, or numpy's;
                 gauss(stream, k) is sixflip_sim.noise's standard normal deviate
    """

    t = 0.0
    temperature = 25.0
    temperature_rate = 0.0
    f = (0.0, 0.0, 1.0)
    w = (0.0, 0.0, 0.0)
    w_rate = (0.0, 0.0, 0.0)
    up = (0.0, 0.0, 1.0)
    table_x = (1.0, 0.0, 0.0)
    table_y = (0.0, 1.0, 0.0)
    before = (0.0, 0.0, 1.0)
    since_move = 0.0
    face = -1
    session = 0
    volts = 3.3
    vibration_mg = 0.0

    def __init__(self, exp=math.exp, sin=math.sin, floor=math.floor, gauss=noise.gauss):
        self.exp = exp
        self.sin = sin
        self.floor = floor
        self.gauss = gauss

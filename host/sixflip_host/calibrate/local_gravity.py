"""Local gravity from latitude and height: WGS84 (NGA.STND.0036 v1.0.0, 2014, ch. 4)."""

import math


def local(lat_deg, height_m=0.0):
    """Normal gravity in m/s2: Somigliana (Eq. 4-1) and free air to second order (Eq. 4-3).

    lat_deg geodetic, -90..90; height_m above the ellipsoid, -1000..20000. ValueError outside.
    """
    if not -90.0 <= lat_deg <= 90.0:
        raise ValueError("latitude %s: expected -90 to 90 degrees" % lat_deg)
    if not -1000.0 <= height_m <= 20000.0:
        raise ValueError("height %s: expected -1000 to 20000 m" % height_m)
    s2 = math.sin(math.radians(lat_deg)) ** 2
    g = 9.7803253359 * (1.0 + 0.00193185265241 * s2) / math.sqrt(1.0 - 0.00669437999014 * s2)
    a, f, m = 6378137.0, 1.0 / 298.257223563, 0.00344978650684
    h = height_m / a
    return g * (1.0 - 2.0 * (1.0 + f + m - 2.0 * f * s2) * h + 3.0 * h * h)

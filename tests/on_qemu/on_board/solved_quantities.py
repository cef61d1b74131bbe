"""Everything a session's solve gives, by name: run here and on the host from the same integers."""

from sixflip.accelerometer import solver as accelerometer
from sixflip.accelerometer.verdict import judge_accelerometer
from sixflip.gyro import solver as gyroscope
from sixflip.gyro.flips import measured_angles
from sixflip.poses.placement import Move, Placement

NOMINAL = [[1.0 if i == j else 0.0 for j in range(3)] for i in range(4)]


def _flat(rows):
    return [x for row in rows for x in row[:3]]


def quantities(placements, moves, accel_lsb, gyro_lsb, measured):
    """({name: [numbers]}, [words]) of tuples for Placement and Move.

    measured: the flips' angles come from the gyro's nominal scale instead of half a turn.
    """
    placements = [Placement(*p) for p in placements]
    moves = [Move(*m) for m in moves]
    angles = measured_angles(placements, moves, gyro_lsb, NOMINAL)
    r = accelerometer.solve(placements, accel_lsb, angles=angles if measured else None)
    numbers = {
        "P, matrix": _flat(r.P[:3]), "P, offset": r.P[3][:3], "scale": r.scale,
        "misalignment T": _flat(r.T), "v": r.v, "sigma P, matrix": _flat(r.sigma_P[:3]),
        "sigma v": r.sigma_v, "residuals": _flat([r.residual[p] for p in sorted(r.residual)]),
        "tilt": [r.tilt_deg], "tilt spread": [r.tilt_spread_deg], "noise": [r.noise_g],
        "scatter": [r.scatter_g]}
    words = [judge_accelerometer(r, placements, accel_lsb), r.level]
    g = gyroscope.solve(placements, moves, gyro_lsb, r.P)
    numbers["gyro matrix"] = _flat(g.P[:3])
    numbers["gyro bias"] = g.bias_dps
    numbers["sigma gyro matrix"] = _flat(g.sigma[:3])
    numbers["flip angles"] = [g.flips[face]["angle_deg"] for face in sorted(g.flips)]
    numbers["measured angles"] = [angles[face] for face in sorted(angles)]
    words += [g.verdict, g.reason, g.missing, sorted(g.flips)]
    return numbers, words


def show(*session):
    """On the board: each number as the bits of its float32, then the words."""
    import struct
    numbers, words = quantities(*session)
    for name in numbers:
        print(name, [struct.unpack("<I", struct.pack("<f", x))[0] for x in numbers[name]], sep=":")
    print("words", repr(words), sep=":")

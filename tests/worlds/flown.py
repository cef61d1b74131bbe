"""A thing that flies about a room and never rests, read by an MPU-6050."""
import numpy as np
from scipy.spatial.transform import Rotation

G, RATE_HZ, FINER = 9.80665, 100.0, 10


def swings(rng, t, sizes, hertz):
    """(n, 3) sums of sines with phases of their own."""
    return sum(size * np.sin(2.0 * np.pi * hz * t[:, None] + rng.uniform(0.0, 6.28, 3))
               for size, hz in zip(sizes, hertz))


def flown(seed, seconds=60.0):
    """(t (n,) s, attitudes (n, 3, 3) body to world, turn rate (n, 3) rad/s of the body, velocity
    and acceleration (n, 3) in the world, m/s and m/s2)."""
    rng = np.random.default_rng(seed)
    step = 1.0 / RATE_HZ / FINER
    t = np.arange(0.0, seconds, step)
    angles = swings(rng, t, (0.5, 0.25, 0.1), (0.13, 0.47, 1.1)) * [2.0, 1.0, 1.0]
    angles[:, 0] += 0.4 * t
    turn = Rotation.from_euler("ZYX", angles)
    rate = (turn[:-1].inv() * turn[1:]).as_rotvec() / step
    rate = 0.5 * (rate + np.roll(rate, 1, axis=0))
    place = swings(rng, t, (1.5, 0.3, 0.05), (0.09, 0.41, 1.3))
    speed = np.gradient(place, step, axis=0)
    some = slice(FINER, -FINER, FINER)
    return (t[some] - t[FINER], turn.as_matrix()[some], rate[some][:len(t[some])], speed[some],
            np.gradient(speed, step, axis=0)[some])


def forces(attitudes, acceleration, gravity=1.0):
    """(n, 3) m/s2: the specific force in the body; gravity: how many times."""
    return np.einsum("nji,nj->ni", attitudes, acceleration + [0.0, 0.0, gravity * G])

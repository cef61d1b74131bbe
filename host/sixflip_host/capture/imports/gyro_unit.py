"""Whether a gyro whose unit nobody said is in deg/s or in rad/s: two hypotheses, a factor of 57
apart, that are weighed by what each would make of the readings.

The unit beside it (a logger that writes m/s2 mostly writes rad/s) is no more than the prior.
Gravity tells where it turns: as far in the accelerometer as by the gyro, and where what
accelerates beside it hides that, the force still swings about as far as the gyro says that all
turns. At rest, where gravity stands still, what the gyro reads across it is its bias, and its
noise is a part's. And no reading lies beyond what the part can turn at.
"""

import math

import numpy as np

from . import gravity, units

# Odds of the unit that goes with the accelerometer's: of a dozen makers' logs one (Xsens DOT)
# writes deg/s beside m/s2. Beside g phones (CoreMotion) and headsets write rad/s: four of the
# sixteen public logs in g that were looked at do. Of a simulator's log, since physics engines
# compute in SI; and of a chip's step, which decimals have by chance once in a thousand.
GOES_WITH, OF_A_SIMULATOR, BY_ITS_STEP = {"m/s2": 9.0, "g": 3.0}, 99.0, 1000.0
DOUBT = 0.05            # chance of the other unit from which on it is told
# How much farther gravity turns in the accelerometer than by the gyro, where it does: what
# accelerates beside it takes up to half, a normal logarithm of 0.4. In how many logs it does at
# all: a flying robot's accelerometer turns by its thrust.
FACTORS = np.exp(np.linspace(-1.0, 1.0, 41))
WEIGHTS = np.exp(-0.5 * (np.log(FACTORS) / 0.4) ** 2)
WEIGHTS /= WEIGHTS.sum()
TURNS, LEAST = 0.7, 1e-12
MOST_SWINGS = 40        # that count: what accelerates beside gravity swings together
BIAS_DPS = 10.0         # zero-rate level: 1 (LSM6DSV) to 20 (MPU-6050 PS 6.1, at most)
# Noise of a sample: 0.05 (MPU-6050 PS 6.1) to 0.38 deg/s (ITG-3205 PS), a third with filters.
NOISE_DPS, NOISE_FACTOR = 0.1, 3.0
RANGE_DPS = 2000.0      # largest range of most parts; of some 4000 (ISM330DHCX, ICM-45686)
TAIL = 2.0              # power of the square with which chances fall beyond: parts are all sorts
REACHED = 0.999         # quantile of the rows that says how fast it turns: single rows are wild
# How much farther the force swings within a fifth of a second than the gyro turns: of 104 public
# logs of what moves 97 have 0.4 to 4, and shaken ones (rovers, a rocket) up to 66, a natural
# logarithm of 1 with long tails. Less says nothing: it turns about the vertical.
SWINGS, SWUNG = 1.0, math.radians(2.0)
STILL = math.radians(1.0)       # that gravity turns by within half a second of rest, at most
FEWEST = 3              # seconds at rest
TELLS = 1.0             # nats from which on something is said for a unit


class Evidence:
    """nats for deg/s over rad/s, and words on what tells that."""

    def __init__(self, accel, gyro, rate_hz):
        self.kinds = [_turning(accel, gyro, rate_hz), *_swinging(accel, gyro, rate_hz),
                      *_at_rest(accel, gyro, rate_hz), _reaching(gyro)]

    @property
    def nats(self):
        return sum(nats for nats, _ in self.kinds)

    def why(self, unit):
        """Words on all that speaks for a unit, "dps" or "rad/s"."""
        sign, other = (1.0, "rad/s") if unit == "dps" else (-1.0, "deg/s")
        per_unit = units.GYRO_UNITS["rad/s" if unit == "dps" else "dps"]
        least = min(TELLS, 0.999 * max(sign * nats for nats, _ in self.kinds))
        turning, *others = [sign * nats > least for nats, _ in self.kinds]
        words = ["so it turns as gravity does in the accelerometer"] if turning else []
        would = [words(per_unit * size) for tells, (_, (words, size)) in zip(
            others, self.kinds[1:]) if tells]
        return ", and ".join(words + (["in %s it would %s" % (other, " and ".join(would))]
                                      if would else []))


def of_captures(captures):
    """(nats, sentence) of a gyro in rad/s over one in deg/s as the captures' headers have it, by
    the capture that says least: what shakes one vehicle shakes it in all of them."""
    nats, words = min(((-one.nats, one.why("rad/s")) for one in (Evidence(
        c.accel / c.meta["accel_lsb_per_g"], c.gyro / c.meta["gyro_lsb_per_dps"],
        c.meta["rate_hz"]) for c in captures)), key=lambda one: one[0])
    return nats, "the gyro is in rad/s and not in the deg/s of the header: " + words


def doubt(captures):
    """[sentence] where a gyro is likelier in rad/s than in the deg/s of the header, as some logs
    are."""
    if any(c.accel is None or c.gyro is None for c in captures):
        return []
    nats, words = of_captures(captures)
    nats -= math.log(GOES_WITH["m/s2"])
    return ["%s (%.0f %%)" % (words, 100.0 / (1.0 + math.exp(-nats)))] if nats > 0.0 else []


def _turning(accel, gyro, rate_hz):
    """(nats, None) of gravity's turning in the accelerometer, by the gyro in either unit."""
    turns = [turn for turn in (way(accel, gyro, 1.0, rate_hz) for way in (
        gravity.turn_factor, gravity.turn_about_a_point)) if turn]
    if not turns:
        return 0.0, None
    turned = max(turns, key=lambda turn: abs(turn.alike))
    # Across gravity there are two directions to turn in; axes with a wrong sign turn against it.
    swings = max(min(2.0 * turned.number / gravity.LAG, MOST_SWINGS), 4.0)
    found = min(abs(turned.alike), 0.999)
    length = found / abs(turned.factor) if found else 0.0

    def likely(alike):
        # Fisher's transformation of a correlation is normal.
        off = math.atanh(found) - np.arctanh(alike)
        return np.exp(-0.5 * (swings - 3.0) * off ** 2)

    chances = []
    for ratio in (1.0, units.GYRO_UNITS["rad/s"]):
        alike = FACTORS * ratio * length    # of what turns by the gyro and what accelerates
        by_gravity = np.where(alike < 1.0, likely(np.minimum(alike, 0.999)), 0.0)
        chances.append(TURNS * float(by_gravity @ WEIGHTS) + (1.0 - TURNS) * float(likely(0.0)))
    return math.log((chances[0] + LEAST) / (chances[1] + LEAST)), None


def _swinging(accel, gyro, rate_hz):
    """[(nats, (words, size))] of how far the force swings and the gyro turns, whatever
    accelerates."""
    m = max(1, int(rate_hz / 20))
    k = min(len(accel) // m, gravity.MOST_TURNS) - gravity.LAG
    if k < gravity.WINDOW:
        return []
    a, w = (values[:(k + gravity.LAG) * m].reshape(k + gravity.LAG, m, 3).mean(axis=1, dtype=float)
            for values in (accel, gyro))
    a /= np.maximum(np.linalg.norm(a, axis=1), 1e-9)[:, None]
    w = np.radians(w - np.median(w, axis=0)) * m / rate_hz
    swung = _rms(a[gravity.LAG:] - a[:k])
    turned = _rms(sum(w[j:j + k] for j in range(1, gravity.LAG + 1)))
    if swung < SWUNG or turned <= 0.0:
        return []
    farther = swung / turned    # in deg/s

    def words(times):
        return "turn by %.2g of what the force swings by" % (times / farther)
    return [(_nats(lambda times: max(math.log(farther / times) / SWINGS, 0.0) ** 2
                   / (2.0 * TAIL), 1.0), (words, 1.0))]


def _rms(vectors):
    return math.sqrt(float((vectors ** 2).sum(axis=1).mean()))


def _at_rest(accel, gyro, rate_hz):
    """[(nats, (words, size))] of the gyro's bias and noise, where gravity stands still."""
    rows = max(gravity.WINDOW, int(rate_hz))
    number = len(accel) // rows
    a, w = (values[:number * rows].reshape(number, rows, 3).astype(float)
            for values in (accel, gyro))
    mean = a.mean(axis=1)
    size = np.maximum(np.linalg.norm(mean, axis=1), 1e-9)
    turned = np.linalg.norm(a[:, :rows // 2].mean(axis=1) - a[:, rows // 2:].mean(axis=1), axis=1)
    still = (np.sqrt(a.var(axis=1).sum(axis=1)) < gravity.QUIET * size) & (turned < STILL * size)
    if still.sum() < FEWEST:
        return []
    up, rate = mean[still] / size[still, None], w[still].mean(axis=1)
    across = rate - (rate * up).sum(axis=1)[:, None] * up
    bias = float(np.median(np.linalg.norm(across, axis=1)))
    noise = float(np.median(np.diff(w[still], axis=1).std(axis=1))) / math.sqrt(2.0)
    kinds = [(_nats(lambda dps: (dps / BIAS_DPS) ** 2, bias),
              ("rest at %.3g deg/s".__mod__, bias))]
    if noise > 0:
        kinds.append((_nats(lambda dps: (math.log(dps / NOISE_DPS) / math.log(NOISE_FACTOR)) ** 2
                            / (2.0 * TAIL), noise),
                      ("have noise of %.3g deg/s at rest".__mod__, noise)))
    return kinds


def _reaching(gyro):
    """(nats, (words, size)) of how fast the gyro says that it turns."""
    top = float(np.quantile(np.abs(gyro).max(axis=1), REACHED))
    return (_nats(lambda dps: (dps / RANGE_DPS) ** 2, top),
            ("turn at %.3g deg/s".__mod__, top))


def _nats(off2, value):
    """Nats for deg/s over rad/s of a value whose chance falls with a power of 1 + off2(deg/s)."""
    return TAIL * (math.log1p(off2(value * units.GYRO_UNITS["rad/s"])) - math.log1p(off2(value)))

"""Smallest sizes of the effects that show in single samples, spectra or motion, by formula.

They leave no signature in the means of rests, so no projection applies; each formula is the
size at which its own test has about 80 % power, for the number of samples of the protocol.
"""
import math

from sixflip_sim.effects import typical
from sixflip_sim.effects.library import EFFECTS

ONE_SEEN = math.log(5.0)  # events expected for one or more with 80 % chance: 1 - exp(-x) = 0.8
TIMESTAMP_US = 500.0  # jitter of a timestamp taken after a bus read
Z = 2.8  # 5 % and 80 %
# In motion the hand is the noise: standard deviation that one move of 3 to 7 s leaves by a hand
# that trembles by 15 mg, how well a hand holds its centre, and the threshold with 80 % power.
LAG_A_MOVE_MS, ARM_A_MOVE_CM, HAND_CM, Z_MOTION, FEWEST_MOVES = 1.0, 1.0, 0.3, 4.5, 12
ALWAYS = "tested on the fitted matrix (nearest signed permutation)"


def samples_of(protocol, rate_hz):
    """(samples at rest, samples moving, seconds) of a protocol."""
    still = sum(r.dwell_s for s in protocol.sessions for r in s.rests)
    still += sum(2 * s.rest_s for s in protocol.sessions)
    moving = sum(r.move_s for s in protocol.sessions for r in s.rests)
    return still * rate_hz, moving * rate_hz, still + moving


def findings(name, protocol, sensor, rate_hz, make, ranges=(None, None)):
    """Findings of one effect (a list, empty for those with a signature at rest)."""
    rule = RULES.get(name)
    if rule is None:
        return []
    effects = []
    for kind in sorted(EFFECTS[name].units):
        chip_kind = "gyro" if kind == "device" and sensor == "itg3205" else kind
        chip_kind = "accel" if chip_kind == "device" else chip_kind
        if (sensor == "adxl345" and chip_kind == "gyro") or \
                (sensor == "itg3205" and chip_kind == "accel"):
            continue
        size, source = typical.size(name, sensor, chip_kind)
        sigma = max(typical.noise_of(sensor, chip_kind, rate_hz, ranges[chip_kind == "gyro"]))
        smallest, how = rule(protocol, rate_hz, sigma, kind)
        if name in ("filter_lag", "lever_arm") and sensor in ("adxl345", "itg3205"):
            smallest, how = math.inf, "the other sensor, which is not there"
        effects.append(make(name, kind, EFFECTS[name].units[kind], smallest, size, source, how=how,
                            absorbed=how if math.isinf(smallest) else ""))
    return effects


def _rare(protocol, rate_hz, sigma, kind):
    still, moving, _ = samples_of(protocol, rate_hz)
    return 100.0 * ONE_SEEN / (still + moving), "one gap in the timestamps is enough"


def _torn(protocol, rate_hz, sigma, kind):
    _, moving, _ = samples_of(protocol, rate_hz)
    if not moving:
        return math.inf, "no motion: the high byte never changes"
    return 100.0 * ONE_SEEN / (moving / 4.0), "jumps near 256 counts while it moves"


def _step(protocol, rate_hz, sigma, kind):
    return 2.0, "common divisor of all counts: by chance 2^-n"


def _band(protocol, rate_hz, sigma, kind):
    return math.inf, "taken for bias unless a rest reads within the band of 0"


def _clock(protocol, rate_hz, sigma, kind):
    seconds = samples_of(protocol, rate_hz)[2]
    return 100.0 * Z * math.sqrt(2.0) * TIMESTAMP_US * 1e-6 / seconds, \
        "against the device timestamps; without them it is an isotropic gyro scale (1.00)"


def _line(protocol, rate_hz, sigma, kind):
    n = samples_of(protocol, rate_hz)[0]
    peak = math.log(n / 2.0 / 0.05) + 2.0 * math.sqrt(math.log(n / 2.0 / 0.05))
    return 2.0 * sigma * math.sqrt(peak / n), "a line in the spectrum of the rests"


def _lag(protocol, rate_hz, sigma, kind):
    moving = samples_of(protocol, rate_hz)[1]
    if not moving:
        return math.inf, "no motion"
    if kind == "device":
        return math.inf, "accelerometer and gyro late together: shows only against a reference"
    _, tilting = moves_of(protocol)
    if tilting < FEWEST_MOVES:
        return math.inf, "too few moves that tilt"
    apart_ms = typical.read_apart(rate_hz) / math.sqrt(len(protocol.sessions))
    return Z_MOTION * math.hypot(LAG_A_MOVE_MS / math.sqrt(tilting), apart_ms), \
        "gravity on the way, against the other"


def _arm(protocol, rate_hz, sigma, kind):
    flips, tilting = moves_of(protocol)
    if flips + tilting < FEWEST_MOVES:
        return math.inf, "too few moves"
    by_chance = ARM_A_MOVE_CM ** 2 / (flips + tilting) + HAND_CM ** 2 / len(protocol.sessions)
    return Z_MOTION * math.sqrt(by_chance), "gravity on the way, less what the hand adds"


def moves_of(protocol):
    """(flips, moves that tilt) of a protocol."""
    pairs = [(a.pose, b.pose) for s in protocol.sessions for a, b in zip(s.rests, s.rests[1:])]
    flips = sum(a[:2] == b[:2] and not a.startswith("L") for a, b in pairs)
    return flips, len(pairs) - flips


def _swap(protocol, rate_hz, sigma, kind):
    return 1.0, ALWAYS


RULES = {"quantisation": _step, "dead_band": _band, "torn_reads": _torn, "sample_rate": _clock,
         "dropped_samples": _rare, "vibration": _line, "filter_lag": _lag, "lever_arm": _arm,
         "axis_swap": _swap}

"""What differs between single and double precision, session by session, from the same integers."""

import ast

import numpy as np

from tests.on_qemu.on_board.solved_quantities import quantities
from tests.shared.flipped_box import gravities, gyro_session, placements

from .simulated_sums import vector_error_mg

LIMIT_MG = 0.01
SHOW = "from solved_quantities import show\nshow(*%r)"
# name: (unit, what to multiply by)
UNITS = {
    "P, matrix": ("mg per g", 1000), "P, offset": ("mg", 1000 / 9.80665),
    "scale": ("mg per g", 1000), "misalignment T": ("mg per g", 1000),
    "v": ("mg", 1000 / 9.80665), "sigma P, matrix": ("mg per g", 1000),
    "sigma v": ("mg", 1000 / 9.80665), "residuals": ("mg", 1000), "tilt": ("deg", 1),
    "tilt spread": ("deg", 1), "noise": ("mg", 1000), "scatter": ("mg", 1000),
    "gyro matrix": ("1", 1), "gyro bias": ("deg/s", 1), "sigma gyro matrix": ("1", 1),
    "flip angles": ("deg", 1), "measured angles": ("deg", 180 / np.pi)}


def session(seed):
    """Arguments of quantities(): tilt, part, hand, chip and flips all drawn from the seed."""
    rng = np.random.default_rng(seed)
    accel_lsb, gyro_lsb = ((16384, 65.5), (256, 14.375))[seed % 2]
    M = np.eye(3) + rng.normal(0, 0.02, (3, 3))
    turned, moves = gyro_session((np.eye(3) + rng.normal(0, 0.02, (3, 3))).tolist(),
                                 rng.normal(0, 2, 3).tolist(), hand_deg=rng.uniform(0, 3),
                                 noise_dps=0.05, lsb=gyro_lsb, seed=seed)
    flips = {face: 180 + rng.normal(0, 1) for face in range(6)}
    still = placements(gravities(rng.uniform(0, 5), flips), M.tolist(),
                       rng.normal(0, 0.05, 3).tolist(), noise_g=0.003, lsb=accel_lsb, seed=seed,
                       across=0.0009)
    means = {p.pose: p for p in still}
    rests = [(p.pose, p.first, p.n, means[p.pose].sums[:3] + p.sums[3:],
              means[p.pose].noise[:3] + p.noise[3:], p.duration_us) for p in turned]
    fields = ("before", "after", "first", "n", "gyro_sums", "duration_us", "late", "saturated",
              "largest_gap_us")
    return rests, [tuple(getattr(m, f) for f in fields) for m in moves], accel_lsb, gyro_lsb, \
        seed % 3 == 0


def on_board(board, sessions):
    """quantities() of each on the board, its float32 values exactly."""
    found, numbers = [], {}
    for line in board.exec(*[SHOW % (given,) for given in sessions]).strip().splitlines():
        name, _, value = line.partition(":")
        value = ast.literal_eval(value)
        if name == "words":
            found.append((numbers, value))
            numbers = {}
        else:
            numbers[name] = np.array(value, dtype=np.uint32).view(np.float32).astype(float)
    if len(found) != len(sessions):
        raise RuntimeError("the board solved %d of %d sessions" % (len(found), len(sessions)))
    return found


def compare(board, seeds):
    """(worst difference and largest size by name, largest vector error in mg, sessions with
    the same words)."""
    worst, largest, vector_mg, same_words = {}, {}, 0.0, 0
    sessions = [session(seed) for seed in seeds]
    for given, (single, single_words) in zip(sessions, on_board(board, sessions)):
        double, double_words = quantities(*given)
        same_words += repr(single_words) == repr(double_words)
        for name, (_, factor) in UNITS.items():
            a, b = np.asarray(single[name]), np.asarray(double[name])
            worst[name] = max(worst.get(name, 0.0), factor * np.max(np.abs(a - b)))
            largest[name] = max(largest.get(name, 0.0), factor * np.max(np.abs(b)))
        P, Q = [np.vstack([np.reshape(n["P, matrix"], (3, 3)), n["P, offset"]])
                for n in (single, double)]
        vector_mg = max(vector_mg, vector_error_mg(P, Q))
    return worst, largest, vector_mg, same_words


def table(found, sessions):
    """The comparison as markdown lines."""
    worst, largest, vector_mg, same_words = found
    lines = ["| quantity | unit | largest | worst difference float32 - float64 |",
             "|---|---|---|---|"]
    for name, (unit, _) in UNITS.items():
        lines.append("| %s | %s | %.4g | %.2g |" % (name, unit, largest[name], worst[name]))
    lines += ["| **corrected vector of 1 g** | mg | 1000 | **%.5f** (limit %.2f) |"
              % (vector_mg, LIMIT_MG),
              "", "%d sessions; verdict and reason alike in %d" % (sessions, same_words)]
    return "\n".join(lines)

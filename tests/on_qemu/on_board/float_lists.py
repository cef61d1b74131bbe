"""The same session as it is usually written: floats in lists, solved when they are all there.

What the bench instructions compares with: windows decide on rest by a fixed limit, the
tilt is solved in rounds. It does not look for saturated, stale or late samples, nor at the gyro
to tell whether the box rests.
"""

WINDOW = 25
AXES = (2, 2, 0, 0, 1, 1)


class FloatSession:
    """feed(sample) -> True once a pose of n samples is complete; its mean then in .mean."""

    def __init__(self, lsb_per_g, lsb_per_dps, n, still_g=0.01):
        self.scales = [1.0 / lsb_per_g] * 3 + [1.0 / lsb_per_dps] * 3
        self.n = n
        self.still_g = still_g
        self.window = []
        self.pose = []

    def feed(self, sample):
        values = [sample[i] * self.scales[i] for i in range(6)]
        self.window.append(values)
        if len(self.window) < WINDOW:
            return False
        if max(deviations(self.window)[:3]) > self.still_g:
            self.pose = []
        else:
            self.pose.extend(self.window)
        self.window = []
        if len(self.pose) < self.n:
            return False
        self.mean = means(self.pose)
        self.pose = []
        return True


def means(rows):
    return [sum([row[i] for row in rows]) / len(rows) for i in range(len(rows[0]))]


def deviations(rows):
    mean = means(rows)
    return [(sum([(row[i] - mean[i]) ** 2 for row in rows]) / (len(rows) - 1)) ** 0.5
            for i in range(len(mean))]


def least_squares(rows, truth):
    """4 x 3: the normal equations as lists of floats, Gauss without pivoting."""
    a = [[sum([r[i] * r[j] for r in rows]) for j in range(4)]
         + [sum([r[i] * t[j] for r, t in zip(rows, truth)]) for j in range(3)] for i in range(4)]
    for k in range(4):
        a[k] = [x / a[k][k] for x in a[k]]
        for i in range(4):
            if i != k:
                a[i] = [x - a[i][k] * y for x, y in zip(a[i], a[k])]
    return [row[4:] for row in a]


def solve(poses, limit=1e-6, rounds=20):
    """P of twelve means in g, Z+a Z+b Z-a ...: flips, the tilt solved."""
    rows = [mean[:3] + [1.0] for mean in poses]
    truth = []
    for pose in range(12):
        t = [0.0, 0.0, 0.0]
        t[AXES[pose // 2]] = 1.0 - pose // 2 % 2 * 2
        truth.append(t)
    P = least_squares(rows, truth)
    done, moved = 1, 1.0
    while done < rounds and moved > limit:
        for face in range(6):
            k = AXES[face]
            a, b = [[sum([rows[p][i] * P[i][j] for i in range(4)]) for j in range(3)]
                    for p in (2 * face, 2 * face + 1)]
            h = [0.5 * (x - y) for x, y in zip(a, b)]
            h[k] = 0.0
            h[k] = (1.0 - face % 2 * 2) * (1.0 - sum([x * x for x in h])) ** 0.5
            truth[2 * face] = h
            truth[2 * face + 1] = [h[j] if j == k else -h[j] for j in range(3)]
        before, P = P, least_squares(rows, truth)
        moved = max([abs(x - y) for p, q in zip(P, before) for x, y in zip(p, q)])
        done += 1
    return P, done

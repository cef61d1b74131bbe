"""How strongly hands (or wheels) shake and shift the box on its way, frequency by frequency.

A spectrum for each kind of move of each session, along each direction, from the moves
themselves: the lowest four frequencies of a move are how it was carried (metres, whatever its
length), those above how it trembled (a density), the mean how well gravity is known on the way.
"""
import numpy as np

# A hand moves with the least jerk [Flash & Hogan, J. Neurosci. 5 (1985) 1688]: 96 % of the square
# of such a move's acceleration is in its first four cosines.
CARRIED = 4
FIRST_HZ, OCTAVE = 0.3, 1.6  # of the bands of the tremor
FEWEST = 4  # values for a level of its own


def bands(move):
    """(n,) band of each frequency and (n,) what a level is multiplied with there."""
    k = np.arange(len(move.y))
    hz = k / (2.0 * move.seconds)
    band = 1 + CARRIED + np.maximum(0, np.log(np.maximum(hz, FIRST_HZ) / FIRST_HZ)
                                    / np.log(OCTAVE)).astype(int)
    band[:CARRIED + 1] = np.arange(CARRIED + 1)
    weight = np.ones(len(k))
    weight[1:CARRIED + 1] = len(k) / move.seconds ** 4
    weight[0] = len(k)
    return band, weight


def white(move):
    """mg²: of the sensor in one bin."""
    return move.white ** 2 / move.bin_s


def spectra(moves, left, weights):
    """list of (n, 3) variances, one of each move. left: what is unexplained of each (n, 3);
    weights (moves,): how far each is believed."""
    groups = {}
    for number, move in enumerate(moves):
        groups.setdefault((move.session, move.flat), []).append(number)
    out = [None] * len(moves)
    for members in groups.values():
        flat = moves[members[0]].flat
        sums = {}
        for number in members:
            band, weight = bands(moves[number])
            square = left[number] ** 2
            if flat:  # no way is onwards
                square = np.stack([0.5 * (square[:, 0] + square[:, 1])] * 2 + [square[:, 2]], 1)
            excess = (square - white(moves[number])) / weight[:, None]
            for b in np.unique(band):
                s = sums.setdefault(int(b), np.zeros(4))
                s[:3] += weights[number] * excess[band == b].sum(axis=0)
                s[3] += weights[number] * (band == b).sum()
        level = _levels(sums)
        for number in members:
            band, weight = bands(moves[number])
            found = np.stack([level[int(b)] for b in band])
            # No level is below the sensor's own noise.
            out[number] = white(moves[number]) + np.maximum(found, 0.0) * weight[:, None]
    return out


def _levels(sums):
    """{band: (3,)}; bands with too little in them are joined with the one before."""
    out, before = {}, None
    for b in sorted(sums):
        total = sums[b].copy()
        if total[3] < FEWEST and before is not None and b > CARRIED + 1:
            total += before
        out[b] = total[:3] / max(total[3], 1e-9)
        before = total
    return out

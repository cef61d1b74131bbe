"""Several effects at once: forward, one candidate a step, with swaps and removals.

A step is taken only when it gains more nats than the threshold of the null simulation; at most
four effects (GAP stage 3).
"""
import numpy as np

from . import which

MOST_EFFECTS, MOST_STEPS = 4, 8


def forward(data, options, threshold):
    """list of Candidates chosen, in the order of their gain; data has R = 1."""
    chosen = []
    while len(chosen) < MOST_STEPS:
        allowed = options
        if len({c.effect for c in chosen}) >= MOST_EFFECTS:
            names = {c.effect for c in chosen}
            allowed = [o for o in options if o.effect in names]
        best, gain = best_of(which.gains(data, allowed, chosen))
        if best is None or gain < threshold:
            break
        chosen.append(best)
        chosen = pruned(data, swapped(data, options, chosen), threshold)
    return chosen


def best_of(gains):
    """(candidate, gain) of the largest gain, (None, -inf) of nothing."""
    best, most = None, -np.inf
    for option, gain in gains.items():
        if gain[0] > most:
            best, most = option, float(gain[0])
    return best, most


def swapped(data, options, chosen):
    """Each one replaced by what does better in its place beside the others."""
    if len(chosen) < 2:
        return chosen
    out = list(chosen)
    for place in range(len(out)):
        others = out[:place] + out[place + 1:]
        gains = which.gains(data, options, others)
        if out[place] not in gains:
            continue
        best, gain = best_of(gains)
        if gain > gains[out[place]][0] + 1.0:
            out[place] = best
    return out


def pruned(data, chosen, threshold):
    """Without those that the others have made superfluous."""
    out = list(chosen)
    while len(out) > 1:
        losses = [which.gains(data, [c], [o for o in out if o is not c]).get(c) for c in out]
        values = [-np.inf if loss is None else float(loss[0]) for loss in losses]
        weakest = int(np.argmin(values))
        if values[weakest] >= threshold:
            break
        del out[weakest]
    return out


def of_effect(data, options, name, others, least=0.5):
    """(candidates, gain): the best that one effect can do beside the others, axis by axis."""
    mine = [o for o in options if o.effect == name]
    taken, total = [], -np.inf
    gains = which.gains(data, mine, others)
    best, gain = best_of(gains)
    while best is not None and (not taken or gain > least) and len(taken) < 3:
        taken.append(best)
        total = gain if len(taken) == 1 else total + gain
        rest = [o for o in mine if o.variant == best.variant and o.axis is not None]
        best, gain = best_of(which.gains(data, rest, list(others) + taken))
    return taken, total

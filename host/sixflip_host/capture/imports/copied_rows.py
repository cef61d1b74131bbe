"""Rows of somebody's table that are one message written over and over: a logger that runs faster
than what it hears writes the last message again, stamp and all."""

import math

import numpy as np

# Of rows that are copies how many are not, such as where a message came amid a row; nats from
# which on rows are taken as copies: a thousand to one, and as much for what is rare.
COPIED_WRONG, SURE = 1e-3, 14.0


def left_out(times, values, labels):
    """(times, {group: values}, labels, bool (n,) True for the rows that stay or None for all, a
    remark); times (n,) or None, labels (n,) or None."""
    new = None if times is None else readings(times, [*values.values()] + (
        [] if labels is None else [labels[:, None]]))
    if new is None:
        return times, values, labels, None, ""
    return (times[new], {group: block[new] for group, block in values.items()},
            None if labels is None else labels[new], new,
            "%d rows are %d readings: the others have the stamp and all values of the row before "
            "them, one message written %.3g times, and are left out" % (
                len(new), new.sum(), len(new) / new.sum()))


def readings(times, blocks):
    """(n,) bool, True for rows that are a reading of their own, or None where all are: where rows
    with one stamp are as well one message written over and over, they have all its values, as rows
    with two stamps have not; what was read and handed over together differs alike in both.

    times (n,); blocks: list of (n, k), all that a row has.
    """
    same = np.ones(len(times) - 1, bool)
    for block in blocks:
        same &= (block[1:] == block[:-1]).all(axis=1)
    together = times[1:] == times[:-1]
    if not together.any():
        return None
    # of rows with two stamps, how many are alike: by chance, and of what rests in coarse steps
    chance = (1.0 + same[~together].sum()) / (2.0 + (~together).sum())
    alike, others = same[together].sum(), (~same[together]).sum()
    nats = alike * math.log((1.0 - COPIED_WRONG) / chance) + others * math.log(
        COPIED_WRONG / (1.0 - chance))
    return np.append(True, ~(together & same)) if nats > SURE else None

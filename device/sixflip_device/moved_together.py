"""What a phase leaves, copied to the front of the heap.

MicroPython's collector moves nothing. Results made among temporary numbers lie scattered, and
between them the next phase's compiler finds no kilobyte in one piece.
"""

from array import array

from sixflip.poses.placement import Move, Placement


def copied(x):
    """A deep copy; objects other than placements and moves are made without arguments."""
    if isinstance(x, float):
        return x + 0.0  # a new object: on most boards a float has a place in the heap
    if isinstance(x, (list, tuple)):
        return type(x)([copied(v) for v in x])
    if isinstance(x, dict):
        return {k: copied(x[k]) for k in x}
    if isinstance(x, array):
        return x[:]
    if isinstance(x, Placement):
        return Placement(x.pose, x.first, x.n, copied(x.sums), copied(x.noise), x.duration_us)
    if isinstance(x, Move):
        new = Move(x.before, x.after, x.first, x.n, copied(x.gyro_sums), x.duration_us,
                   copied(x.late), x.saturated, x.largest_gap_us)
        new.path = copied(x.path)
        return new
    if not hasattr(x, "__dict__"):
        return x
    new = type(x)()
    for name in x.__dict__:
        setattr(new, name, copied(getattr(x, name)))
    return new


def move(unit):
    unit.taken = copied(unit.taken)

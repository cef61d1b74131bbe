"""Instructions of the emulated processor for a sample and for a solve, ours and float lists'.

QEMU with `-icount shift=6` lets 64 ns pass with every instruction; timer 0 of the MPS2 (a CMSDK
APB timer) counts down at 25 MHz, so its ticks of 40 ns are 5/8 of an instruction. It starts
anew from the largest small integer: looking at it allocates nothing.
"""

import gc
from array import array

from machine import mem32

CONTROL, VALUE, RELOAD = 0x40000000, 0x40000004, 0x40000008
LARGEST = 0x3FFFFFFF
EVERY = 25  # samples between two looks at the heap


def start():
    mem32[RELOAD] = mem32[VALUE] = LARGEST
    mem32[CONTROL] = 1


def took(act, argument):
    """Instructions of act(argument), those of a call of nothing taken off; its answer."""
    before = mem32[VALUE]
    nothing(argument)
    between = mem32[VALUE]
    answer = act(argument)
    after = mem32[VALUE]
    return (((between - after) & LARGEST) - ((before - between) & LARGEST)) * 5 // 8, answer


def nothing(argument):
    pass


def samples():
    """Counts of the session on tape, a sample each, in the same array."""
    import tapes
    tape = tapes.BURSTS["mpu6050"][0]
    sample = array("h", [0] * 7)
    for at in range(0, len(tape), 14):
        for i in range(7):
            column = i if i < 3 else (6 if i == 3 else i - 1)
            word = tape[at + 2 * i] << 8 | tape[at + 2 * i + 1]
            sample[column] = (word ^ 0x8000) - 0x8000
        yield sample


def over_the_tape(name, make):
    """make() -> feed(sample), twice. Prints samples, instructions of all of them and of the
    longest, collections of garbage included as they come; bytes allocated; most bytes held."""
    gc.collect()
    held = gc.mem_alloc()
    feed = make()
    n = total = worst = 0
    for sample in samples():
        count, _ = took(feed, sample)
        total += count
        worst = max(worst, count)
        n += 1
    feed = make()
    gc.collect()
    last = gc.mem_alloc()
    most = garbage = 0
    for i, sample in enumerate(samples()):
        feed(sample)
        if i % EVERY == 0:
            garbage += gc.mem_alloc() - last
            gc.collect()
            last = gc.mem_alloc()
            most = max(most, last - held)
    print(name, n, total, worst, garbage, most)


def run(pose_samples):
    """Prints a line each: name and whole numbers; the last how far the two solutions are apart."""
    from float_lists import FloatSession
    from float_lists import solve as solve_lists

    from sixflip.accelerometer import solver as accelerometer
    from sixflip.accelerometer.six_faces import solve as solve_means
    from sixflip.capture.writer import BlockWriter
    from sixflip.poses.session import Session
    start()
    made = [None]

    def session():
        made[0] = Session(16384, 65.5, 32767, 32767, 100, pose_samples=pose_samples)
        return lambda sample: made[0].feed(10000, sample)

    def capture():
        writer = BlockWriter(lambda data: None, b"{}")
        return lambda sample: writer.add(10000, sample)

    poses = []

    def lists():
        one = FloatSession(16384, 65.5, pose_samples)
        poses.clear()

        def feed(sample):
            if one.feed(sample):
                poses.append(one.mean)
        return feed

    over_the_tape("session", session)
    over_the_tape("capture", capture)
    over_the_tape("lists", lists)
    placements = made.pop().placements
    print("poses", len(placements), len(poses))

    codes = [p.pose for p in placements]
    means = [accelerometer.mean_in_g(p, 16384) for p in placements]
    count, ours = took(lambda means: solve_means(codes, means, "tilt solved"), means)
    print("solve", count, ours[2])
    count, theirs = took(solve_lists, means)
    print("solve_lists", count, theirs[1])
    print("apart", max([abs(x - y) for p, q in zip(ours[0], theirs[0]) for x, y in zip(p, q)]))

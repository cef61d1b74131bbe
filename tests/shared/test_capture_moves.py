"""Moves out of a file are those that the session itself had; pauses in a turn are bridged."""

import math
import unittest
from array import array

from synthetic_operator import Operator

from sixflip.capture.blocks import STEPS
from sixflip.capture.scan import CaptureMoves, Scan, samples_in
from sixflip.capture.writer import BlockWriter
from sixflip.gyro import solver
from sixflip.poses.placement import turned
from sixflip.poses.placement_log import add_window, empty_move
from sixflip.poses.session import Session
from sixflip.poses.still_window import StillWindow

META = b"{}"


class Stream:
    """A file of blocks as Scan reads it, in pieces as they were written: a small heap has no
    room for one that grows."""

    def __init__(self):
        self.pieces = []
        self.rewind()

    def rewind(self):
        self.piece = self.at = 0

    def write(self, data):
        self.pieces.append(bytes(data))

    def read(self, n):
        out = b""
        while len(out) < n and self.piece < len(self.pieces):
            here = self.pieces[self.piece]
            out += here[self.at:self.at + n - len(out)]
            self.at += n
            if self.at >= len(here):
                self.piece += 1
                self.at = 0
            else:
                break
        return out


class Kept:
    """A session and the file of its samples; the intervals are as a board's that writes."""

    PAUSES = {700: 80000, 701: 4000, 1200: 52000, 1950: 13000, 2100: 12000, 2101: 8000}

    def __init__(self, aligned=False):
        self.aligned = aligned  # a block ends where a placement begins
        self.session = Session(16384, 65.5, 32767, 32767, 100)
        self.file = Stream()
        self.writer = BlockWriter(self.file.write, META)
        self.hands = Operator(self.feed)

    def feed(self, dt_us, sample):
        dt_us = self.PAUSES.get(self.session.samples, dt_us)
        was = self.session.state
        event = self.session.feed(dt_us, sample)
        self.writer.add(dt_us, sample)
        if self.aligned and (was == "capturing") != (self.session.state == "capturing"):
            self.writer.flush()
        return event

    def moves(self, placements=None, begin=0, end=0):
        """Those between the placements (None: all), the blocks of samples begin..end left out."""
        self.writer.flush()
        self.file.rewind()
        scan = Scan(self.file)
        found = CaptureMoves(placements or self.session.placements, scan.blocks.columns, 10000,
                             32767, 65.5)
        at = 0
        for kind, block in scan.each():
            if kind == STEPS:
                n = samples_in(block)
                if begin <= at and at + n <= end:
                    found.skip(n)
                else:
                    found.block(block)
                at += n
        return found.moves()


def content(move):
    return (move.before, move.after, move.first, move.n, move.gyro_sums, move.duration_us,
            move.late, move.saturated, move.largest_gap_us)


class FromTheFile(unittest.TestCase):
    def same(self, kept):
        moves = kept.moves()
        own = kept.session.moves
        self.assertEqual([content(m) for m in moves[:-1]], [content(m) for m in own])
        return moves[-1], kept.session._log.open

    def test_the_same_as_the_sessions_own(self):
        kept = Kept()
        kept.hands.six_faces(order=(0, 3))
        kept.hands.place(1)
        kept.hands.rest(0.25)
        last, own = self.same(kept)
        self.assertEqual(last.gyro_sums, own.gyro_sums)
        self.assertEqual((last.n, last.late), (own.n, own.late))

    def test_it_ended_with_a_pose(self):
        kept = Kept()
        kept.hands.six_faces(order=(4,), dwell=6)
        end = kept.session.placements[-1]
        kept.hands.samples(-(end.first + end.n) % 25)
        last, own = self.same(kept)
        self.assertEqual(last.n, kept.session.samples - end.first - end.n)

    def test_saturation_is_seen(self):
        kept = Kept()
        kept.hands.place(0)
        kept.hands.rest(6)
        kept.hands.turn(2, 180, 0.3)
        kept.hands.rest(6)
        self.assertEqual([m.saturated for m in kept.moves()], [False, True, False])

    def test_of_moves_whose_samples_were_not_kept_nothing_is_known(self):
        kept = Kept()
        kept.hands.six_faces(order=(0,))
        kept.file.pieces = kept.file.pieces[:len(kept.file.pieces) // 2]
        kept.writer._write = lambda data: None
        self.assertEqual([move.n > 0 for move in kept.moves()], [True, False, False])

    def test_of_a_move_that_was_left_out_no_turn_is_known(self):
        """As where a face is taken again: its blocks, and those of the moves to it and from it,
        are not copied, and now and then a block ends just where the next placement begins."""
        for aligned in (True, False):
            kept = Kept(aligned)
            kept.hands.six_faces(order=(0, 2, 4))
            stay = [p for p in kept.session.placements if p.pose not in (5, 6)]
            moves = kept.moves(stay, stay[1].first + stay[1].n, stay[2].first)
            self.assertEqual([m.n > 0 for m in moves], [True, True, not aligned, True, True])
            self.assertEqual([m.path for m in moves], [None] * 5)
            straight = [[float(i == j) for j in range(4)] for i in range(4)]
            gyro = solver.solve(stay, moves, 65.5, straight, lsb_per_g=16384)
            self.assertEqual((gyro.missing, gyro.excess), ([0], None))  # X+ is not there


class Pauses(unittest.TestCase):
    def flip(self, pauses, seconds=1.2):
        """Degrees of half a turn whose rate rises and falls like a cosine, as summed up with
        samples that are late by so many us."""
        window = StillWindow(60, 32767, 32767, 10000)
        move = empty_move(0)
        move.before, move.after = 0, 1
        t = 0
        while t < (seconds + 0.4) * 1000000:
            dt = 10000 + pauses.get(window.n + move.n, 0)
            t += dt
            phase = 2 * math.pi * (t * 1e-6 - 0.2) / seconds
            rate = 180 / seconds * (1 - math.cos(phase)) if 0 < phase < 2 * math.pi else 0
            if window.add(dt, array("h", [0, 0, 16384, 0, 0, int(rate * 65.5), 0])):
                add_window(move, window)
                window.clear()
        add_window(move, window)
        return turned(move, 2) / 65.5

    def test_a_pause_in_a_brisk_turn_is_bridged(self):
        self.assertAlmostEqual(self.flip({}), 180, delta=0.05)
        for at in range(22, 140, 7):
            self.assertAlmostEqual(self.flip({at: 45000}), 180, delta=0.1)
            self.assertAlmostEqual(self.flip({at: 80000}), 180, delta=0.3)
        worst = max(abs(self.flip({at: 150000}) - 180) for at in range(22, 140, 3))
        self.assertLess(worst, 1.5)
        self.assertGreater(worst, 0.5)  # so that it is not measured beside the turn

    def test_several_pauses_in_one_turn(self):
        self.assertAlmostEqual(self.flip({40: 45000, 80: 60000, 81: -5000, 100: 45000}),
                               180, delta=0.3)


if __name__ == "__main__":
    unittest.main()

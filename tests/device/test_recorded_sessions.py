"""A session whose capture the host writes down while it is taken: all of it, and only once."""

import os
import tempfile
import unittest

from sixflip.capture.reader import read as read_blocks
from sixflip_device import flash_files
from sixflip_device.capture import store
from sixflip_host.board.stream_reader import decode_piece
from sixflip_sim import worlds
from tests.worlds.simulated_board import STOP_WHEN_READY, SimulatedBoard, power_on

WORLD = {"first_rest_s": 6.0, "dwell_s": 4.0, "move_s": 1.5, "tilt_deg": 1.0,
         "order": ["Z+a", "Z+b", "X+a", "X+b"]}


class Recorded(SimulatedBoard):
    """A board whose bytes are kept."""

    wire = b""
    enough = 1 << 30  # bytes, then the host says stop

    def write_bytes(self, data):
        self.wire += data
        if len(self.wire) > self.enough:
            self._lines.append('{"cmd": "stop"}')

    def pieces(self):
        found = [decode_piece(line) for line in self.wire.split(b"\n") if line]
        assert [piece[0] for piece in found] == list(range(len(found)))
        return found


class TestRecording(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = os.path.join(self.folder.name, "")

    def tearDown(self):
        store.free_bytes = flash_files.free_bytes
        self.folder.cleanup()

    def board(self, request, *answers):
        with open(self.root + "calibrate.flag", "w") as f:
            f.write(request)
        board = Recorded(worlds.make(WORLD), self.folder.name,
                         [list(STOP_WHEN_READY), *[list(a) for a in answers]])
        return power_on(None, board=board, timeout_s=12)

    def file(self, name="refused.bin"):
        with open(self.root + name, "rb") as f:
            return f.read()

    def test_what_comes_over_the_wire_is_what_the_flash_keeps(self):
        board = self.board('{"record": true}')
        self.assertTrue(board.only("calibrating")["recorded"])
        pieces = [piece for _, _, piece in board.pieces()]
        again = [piece for piece in set(pieces) if pieces.count(piece) == 2]
        self.assertEqual(len(again), 4)  # the poses, once more at the end
        for piece in again:
            pieces.reverse()
            pieces.remove(piece)
            pieces.reverse()
        self.assertEqual(b"".join(pieces), self.file())
        got = read_blocks(self.file())
        self.assertEqual((len(got.placements), got.damage), (4, ""))
        self.assertGreater(len(got.t_us), 1000)

    def test_the_samples_before_each_piece_are_counted(self):
        board = self.board('{"record": true}')
        n = 0
        for _, samples, piece in board.pieces():
            self.assertEqual(samples, n)
            n += piece[12] if piece[0] == 6 and piece[:4] != b"6CAP" else 0
        self.assertEqual(n, len(read_blocks(self.file()).t_us))

    def test_the_host_gets_what_the_flash_has_no_room_for(self):
        store.free_bytes = lambda root: 30000
        board = self.board('{"poses": "Z+a Z+b X+a X+b", "samples": 100, "record": true}')
        flash = read_blocks(self.file("refused.bin"))
        self.assertTrue(flash.sums_only and not len(flash.t_us))
        seen = {}
        for _, _, piece in board.pieces():
            seen[piece] = True
        host = read_blocks(b"".join(seen))
        self.assertEqual((host.sums_only, host.damage), (False, ""))
        self.assertEqual(host.samples, flash.samples)
        self.assertEqual(len(host.t_us), host.samples)
        self.assertEqual(len(host.placements), 4)

    def test_a_header_that_was_lost_is_sent_again(self):
        board = self.board('{"record": true}', ["pose", '{"cmd": "record"}', 1])
        pieces = [piece for _, _, piece in board.pieces()]
        self.assertEqual(pieces.count(pieces[0]), 2)
        self.assertEqual(pieces[0][:4], b"6CAP")

    def test_nobody_asked_and_nothing_is_sent(self):
        for request in ("", '{"poses": "Z+a Z+b"}'):
            board = self.board(request)
            self.assertEqual(board.wire, b"")
            self.assertFalse(board.only("calibrating")["recorded"])

    def test_a_stream_of_blocks_for_logs_without_a_session(self):
        """Asked for when the first session has timed out; every sample, 0.32 s a block."""
        board = Recorded(worlds.make(dict(WORLD, order=[])), self.folder.name, [
            ["ready", '{"cmd": "stream", "record": true, "hz": 0}', 1]])
        board.enough = 5000
        power_on(None, board=board, timeout_s=12)
        got = read_blocks(b"".join([piece for _, _, piece in board.pieces()]))
        self.assertLess(max(b - a for a, b in zip(got.t_us, got.t_us[1:])), 11000)
        self.assertGreater(len(got.t_us), 200)
        self.assertEqual(got.placements, [])


if __name__ == "__main__":
    unittest.main()

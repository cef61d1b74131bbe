"""A cable that fails while a board is provisioned, calibrated or pulled. The bench
serial_faults cuts a provisioning everywhere and has more seeds."""

import random
import time

import pytest
from mpremote.transport_serial import SerialTransport

from sixflip_host.board.board_link import MpremoteLink
from sixflip_host.board.buffered_serial import BufferedSerial, Endless
from sixflip_host.errors import NoBoard
from sixflip_host.virtual.virtual_board import VirtualBoard
from tests.faults import serial_faults as faults
from tests.faults.serial_faults import BadCable, verb

SESSION = {"sensor": "mpu6050", "seed": 3, "tilt_deg": 2.0}


@pytest.fixture(autouse=True)
def impatient():
    with faults.impatient():
        yield


@pytest.fixture(scope="module")
def provisioned(micropython, tmp_path_factory):
    return faults.Provisioned(micropython, tmp_path_factory.mktemp("provisioned"))


def in_one_line(code, error):
    return code in faults.ENDS and "Traceback" not in error and (
        code != 3 or error.count("\n") == 1)


@pytest.mark.parametrize("operation", sorted([*random.Random(4).sample(range(80), 3), 66]))
def test_provision_cut_off_leaves_the_old_or_the_new_firmware(provisioned, operation):
    started, cut, after, left = provisioned.cut_at(operation)
    assert cut
    assert started in ([1, 1, 1], [2, 2, 2])
    assert after == [2, 2, 2]
    assert left == []


@pytest.mark.parametrize("seed", range(3))
def test_pull_over_a_bad_cable(micropython, tmp_path, seed):
    with VirtualBoard(faults.STILL, tmp_path / "f.img", micropython=micropython) as board:
        pulled = faults.Pulled(board, tmp_path / "here")
        code, error, wrong = pulled.pull(BadCable(seed, 0.02, 200 * seed))
        assert in_one_line(code, error), error
        assert wrong == ""


@pytest.mark.long
def test_provision_over_a_bad_cable_and_calibrate_cut_off(micropython, tmp_path):
    with VirtualBoard(SESSION, tmp_path / "f.img", micropython=micropython) as board:
        board.relay.corrupt = BadCable(1, 0.05, 3000)
        code, error = verb("provision", "--port", board.port)
        assert in_one_line(code, error), error
        board.relay.corrupt = None
        assert verb("provision", "--port", board.port)[0] == 0
        kept = faults.calibrate_and_pull_out(board, "X+a")
        assert len(kept.placements) >= 5
        assert len(kept.t_us) > 2500


class Half:
    """A port that answers with half of what was asked for."""

    def read(self, n):
        return b"x" * (n // 2)


def test_an_answer_cut_short_is_a_lost_board(monkeypatch):
    monkeypatch.setattr(MpremoteLink, "open", lambda link: None)
    link = MpremoteLink("/dev/ttyNONE")
    link.transport = SerialTransport.__new__(SerialTransport)
    link.transport.serial = Half()
    with pytest.raises(NoBoard, match="went away while asking"), link.guarded("asking") as port:
        port.raw_paste_write(b"1")


class Talking:
    """A port that talks without end."""

    in_waiting = 4096
    timeout = write_timeout = None

    def read(self, n):
        return b"x" * n


def test_a_port_that_never_stops_talking_has_its_share():
    wire = BufferedSerial(Talking(), timeout=60)
    wire.most = 100000
    taken = 0
    started = time.monotonic()
    with pytest.raises(Endless, match="too long"):
        while time.monotonic() < started + 60:
            taken += len(wire.read(1000))
    assert 100000 < taken < 102000
    wire.most, wire.deadline = None, started
    with pytest.raises(Endless, match="in time"):
        wire.inWaiting()

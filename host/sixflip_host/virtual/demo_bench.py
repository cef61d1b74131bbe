"""The board of a demo, its sensor and its operator: virtual, local or an emulated Pico."""

import contextlib
from typing import NamedTuple

from ..board.board_link import MpremoteLink
from ..board.event_words import GUIDED_ORDER
from ..errors import SixflipError
from ..terminal import plain
from . import demo_truth, micropython_fetch

TILT_DEG = 2.0  # of the table
PLACEMENT_DEG, FLIP_DEG = 0.05, 0.4  # how exactly a hand lays the box down, and turns it


class Pace(NamedTuple):
    """What a board's speed asks for: settings of the firmware, the hand, poses and samples a
    second of the stream after the power cycle."""

    settings: dict
    hand: dict
    after: tuple
    stream_hz: int


USUAL = Pace({}, {}, ("Z+a", "Z-a", "X+a", "X-a", "Y+a", "Y-a"), demo_truth.STREAM_HZ)
PACE = {"virtual": USUAL, "local": USUAL,
        # a sample costs the emulated Pico a third of a second: few of them, and quick moves
        "pico": Pace({"rate_hz": 25, "pose_samples": 50, "grace_ms": 100, "rest_s": 2},
                     {"dwell_s": 4.2, "move_s": 1.0}, ("Z+a", "X-a", "Y+a"), 10)}


def make_world(spec):
    """The same world as on the board, to know the truth."""
    from sixflip_sim import worlds
    return worlds.make(spec)


def first_spec(board, sensor, seed):
    """The sensor, and a person with a table that is not level."""
    return {"sensor": sensor, "seed": seed, "tilt_deg": TILT_DEG,
            "order": GUIDED_ORDER, **PACE[board].hand,
            "flip_error_deg": FLIP_DEG, "placement_scatter_deg": PLACEMENT_DEG}


def second_spec(board, sensor, seed, first):
    """The same sensor on a level table after the power cycle, other noise, faces once each."""
    truth = make_world(first).truth
    mg = [b / demo_truth.G * 1000 for b in truth.accel_bias]
    dps = [b * 57.29577951308232 for b in truth.gyro_bias]
    return {"sensor": sensor, "seed": seed + 1000, "tilt_deg": 0.0,
            "accel_matrix": truth.accel_matrix, "accel_bias_mg": mg,
            "gyro_matrix": truth.gyro_matrix, "gyro_bias_dps": dps,
            "order": list(PACE[board].after), **PACE[board].hand, "first_rest_s": 12.0}


@contextlib.contextmanager
def virtual_bench(folder, spec, micropython):
    """(link, power_cycle(world)) of a virtual board."""
    from .virtual_board import VirtualBoard
    with VirtualBoard(spec, folder / "flash.img", micropython=micropython) as board:
        print("virtual board at %s (%s)" % (board.port, micropython))
        with MpremoteLink(board.port) as link:
            yield link, board.power_cycle


@contextlib.contextmanager
def local_bench(folder, spec):
    """(link, power_cycle(world)) of the firmware under CPython."""
    from ..board.local_link import LocalLink
    with LocalLink(folder / "flash", spec) as link:
        yield link, link.power_cycle


@contextlib.contextmanager
def pico_bench(folder, spec):
    """(link, power_cycle(world)) of an emulated Pico."""
    from ..emulated.emulated_pico import PATIENCE, PicoBoard
    with PicoBoard(spec, folder / "flash.img") as board:
        print("emulated Pico at %s (%s); it takes most of an hour" % (board.port, board.uf2.name))
        with MpremoteLink(board.port, PATIENCE) as link:
            yield link, board.power_cycle


def bench(board, folder, spec):
    """The bench asked for, or the one that can be had."""
    if board == "pico":
        return pico_bench(folder, spec)
    if board == "virtual":
        try:
            return virtual_bench(folder, spec, micropython_fetch.fetch())
        except SixflipError as error:
            print(plain("no MicroPython to be had: %s" % error))
            print("running the same firmware under CPython instead")
    return local_bench(folder, spec)

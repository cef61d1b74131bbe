"""Every fault at every step of the protocol, once: where the steps are is read off a run
without faults."""

import functools

from tests.faults import storm

# One of each, of a size a working bus has now and then.
FAULTS = (
    {"kind": "nak"}, {"kind": "data_nak"}, {"kind": "timeout"},
    {"kind": "stuck_sda", "pulses": 9}, {"kind": "reset"}, {"kind": "sleep"},
    {"kind": "frozen", "for_ms": 300}, {"kind": "unplugged", "for_ms": 300},
    {"kind": "wrong_id", "value": 0x12}, {"kind": "torn", "byte": 5},
    {"kind": "garbled", "byte": 0, "bits": 0x40}, {"kind": "duplicate"},
    {"kind": "late", "us": 90000}, {"kind": "noise"})
FIRST = ("probe", "configure", "read-back", "self-test", "still window", "pose capture",
         "flip move", "face move", "last window", "save")
SECOND = ("power-up", "rest", "stream")
STEPS = FIRST + SECOND
# At these steps nothing is written and no ID is read any more.
NO_MORE = {("data_nak", "rest"), ("data_nak", "stream"), ("wrong_id", "rest"),
           ("wrong_id", "stream")}


def places(sensor):
    """{step: number of the transaction at which it is under way}."""
    writes = []
    clean = storm.calibration(sensor=sensor, watch=writes)
    first, second = clean.boards
    at = {"probe": 0, "configure": writes[0], "read-back": writes[0] + 1,
          "power-up": 1}

    def after(board, name, more, n=0):
        return [t for t, e in board.steps if e["event"] == name][n] + more

    at["self-test"] = after(first, "hello", 10)
    at["still window"] = after(first, "calibrating", 10)
    at["pose capture"] = [t for t, e in first.steps if e["event"] == "state"
                          and e["state"] == "capturing" and e["pose"] == "X+a"][0] + 20
    at["flip move"] = after(first, "pose", 15)
    at["face move"] = after(first, "pose", 15, 1)
    at["last window"] = after(first, "capture", -3)
    at["save"] = after(first, "capture", 0)
    at["rest"] = after(second, "record", 20)
    at["stream"] = after(second, "ready", 10)
    return at


@functools.cache
def _sound(sensor):
    """A calibration without faults, for all that happen after it, and its world."""
    spec = dict(storm.WORLD, seed=1, flavour="rp2", **storm.SENSORS[sensor])
    return storm.calibrated(spec), spec


def run(sensor, step, fault, at, address=None):
    """(Outcome, whether the fault happened)."""
    fault = dict(fault, at=at[step])
    if address is not None:
        fault["address"] = address
    later = step in SECOND
    outcome = storm.powered_again(*_sound(sensor), (fault,)) if later else storm.calibration(
        1, sensor, "rp2", (fault,))
    board = outcome.boards[1 if later else 0]
    return outcome, bool(board.world.i2c.faults.happened)

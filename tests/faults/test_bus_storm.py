"""A bus that fails: at every step of the protocol once, and at random. What comes of it is the
right correction or a refusal with its reason. The bench bus_storm runs ten thousand."""

import collections
import gc

import pytest

from tests.faults import fault_matrix, storm

NAMES = ("mpu6050", "gy85", "mpu6500")


@pytest.fixture(scope="module", autouse=True)
def frozen():
    """The firmware collects garbage between its phases: not all of pytest's."""
    gc.collect()
    gc.freeze()
    yield
    gc.unfreeze()


@pytest.fixture(scope="module")
def places():
    return [fault_matrix.places(sensor) for sensor in range(2)]


def must_be_good(fault, step):
    """A gyro that hangs while the box is flipped is noticed, and only that is not mended."""
    return (fault["kind"], step) != ("frozen", "flip move")


@pytest.mark.parametrize("step", fault_matrix.STEPS)
def test_each_fault_at_each_step(places, step):
    """The two chips of a GY-85 take turns, over faults and steps."""
    for number, fault in enumerate(fault_matrix.FAULTS):
        sensor = (number + fault_matrix.STEPS.index(step)) % 2
        address = (None, (0x53, 0x68)[number // 2 % 2])[sensor]
        outcome, happened = fault_matrix.run(sensor, step, fault, places[sensor], address)
        what = (NAMES[sensor], fault, outcome.reason)
        assert happened or (fault["kind"], step) in fault_matrix.NO_MORE, what
        allowed = ("good",) if must_be_good(fault, step) else ("good", "doubtful", "refused")
        assert outcome.word in allowed, what


@pytest.mark.parametrize("part", range(4))
def test_random_storms(part):
    words = collections.Counter()
    for seed in range(part, 80, 4):
        outcome, kinds = storm.storm(seed)
        assert outcome.word != "wrong", (seed, kinds, outcome.reason)
        words[outcome.word] += 1
    assert words["good"] > 5 and words["refused"] > 0, words


@pytest.mark.parametrize("sensor", range(len(storm.SENSORS), len(storm.SENSORS + storm.MORE)))
def test_random_storms_over_every_other_chip(sensor):
    words = collections.Counter()
    for seed in range(8 * sensor, 8 * sensor + 8):
        outcome, kinds = storm.storm(seed, sensor)
        assert outcome.word != "wrong", (storm.MORE[sensor - 3], seed, kinds, outcome.reason)
        words[outcome.word] += 1
    assert words["good"] > 1, words


def test_a_wrong_correction_is_noticed_as_one():
    """The judge of all the above, on a record that says another scale than the world has."""
    outcome = storm.calibration()
    assert outcome.word == "good"
    world = outcome.boards[0].world
    record = outcome.record
    for row, scale in ((0, 1.01), (2, 0.99)):
        record.accel["P"][row] = [scale * x for x in record.accel["P"][row]]
    storm.compare(outcome, world.truth, record)
    assert outcome.word == "wrong" and "called good with an error" in outcome.reason


def test_flips_that_lean_unlike_each_other_make_the_gyro_doubtful():
    """Two garbled samples in mid-flip: 4 degrees about another axis, on one of two flips."""
    outcome, _ = storm.storm(9502)
    assert outcome.word == "good" and outcome.gyro > storm.GYRO
    gyro = outcome.boards[0].only("solved")["gyro"]
    assert gyro["verdict"] == "doubtful" and "another axis" in gyro["reason"]

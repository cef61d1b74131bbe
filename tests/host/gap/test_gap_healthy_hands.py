"""What hands do, and how far noise is known, is in the model with levels of its own: no gap."""
import numpy as np
import pytest

from sixflip_host.diagnosis import diagnosis, stray_turns, turn_model
from sixflip_host.diagnosis.detect import torn_reads
from sixflip_host.diagnosis.detect.detection import present
from sixflip_host.experiment import attitude_fit, block_noise, blocks
from sixflip_host.simulation import scenario, simulated_session

KNOWN_DEG = 0.03


def ends(number, seed, lost=(), tails=np.inf):
    """stray_turns.Ends of a session whose turns are off by 0.05 deg, those lost by 12."""
    generator = np.random.default_rng(seed)
    columns = generator.standard_normal((number, 2, 12))
    columns[0] *= 30.0  # one turn that the unknown bend to as they like
    off = 0.05 * generator.standard_normal((number, 2))
    if np.isfinite(tails):
        off = 0.05 * generator.standard_t(tails, (number, 1)) * np.sign(off)
    off[list(lost)] += 12.0
    return stray_turns.Ends(off + columns @ generator.normal(0.0, 0.2, 12), columns,
                            np.full((number, 2), KNOWN_DEG ** 2))


@pytest.mark.parametrize("seed", range(4))
def test_few_turns_that_much_is_fitted_to_are_none_that_end_far_off(seed):
    """Judged by what a fit leaves, the turns that decide it are near 0 and one other is not."""
    assert not present(stray_turns.nats([ends(11, seed)])[0])
    assert not present(stray_turns.nats([ends(40, seed, tails=4.0)])[0])


def test_turns_that_samples_were_lost_in_end_far_off():
    nats, number = stray_turns.nats([ends(40, 1, lost=(5, 11, 30)), ends(38, 2)])
    assert present(nats) and number == pytest.approx(3.0, abs=0.1)


def test_a_hand_that_turns_by_half_a_circle_carelessly_is_no_gap_of_the_gyro():
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 4,
                               "world": {"flip_error_deg": 1.6}})
    session = blocks.of("s", simulated_session.session(plan, 0))
    nominal = attitude_fit.fit(session)
    gap = turn_model.TurnModel("gyro", "mpu6050", diagnosis.Settings(jobs=1)).fit(
        [session], [nominal])
    assert gap.adequacy.ok and not gap.found.best.forms
    assert gap.units[0].grid[gap.adequacy.index[0]][1] >= 0.8


def test_noise_near_the_edge_of_a_page_is_no_torn_read():
    """A page of four standard deviations, its edge 1.8 off the level: a level known by six
    samples only made twice as many samples look torn as can be."""
    generator = np.random.default_rng(3)
    column = np.rint(16384 + 149.0 + 59.0 * generator.standard_normal(38000)).astype(np.int64)
    assert not present(torn_reads.competed(torn_reads.tabled(column, False))[0])


def test_white_noise_is_known_as_well_as_its_degrees_of_freedom_say():
    generator = np.random.default_rng(5)
    first = np.arange(0, 20000, 250)
    found = np.array([block_noise.white(generator.standard_normal((20000, 3)), first, first + 250,
                                        100.0) for _ in range(60)])
    scatter = (100.0 * found ** 2).mean(axis=1).var()
    assert 2.0 / scatter == pytest.approx(block_noise.freedom(first, first + 250, 100.0), rel=0.5)

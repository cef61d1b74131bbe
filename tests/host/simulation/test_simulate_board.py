"""The firmware's own session over simulated chips, against the pure numpy simulator."""
import numpy as np
import pytest

from sixflip_host.capture import capture_file
from sixflip_host.simulation import simulator
from sixflip_sim import worlds
from tests.worlds.simulated_board import SHORT_WORLD, STOP_WHEN_READY, SimulatedBoard, power_on

EFFECTS = [{"effect": "thermal_bias", "x": 0.5, "z": -0.9}, {"effect": "creep", "z": 2.0},
           {"effect": "quantisation", "x": 4, "y": 4, "z": 4}, {"effect": "quadratic", "z": 3.0},
           {"effect": "drift", "x": 0.1, "y": 0.1, "z": 0.1},
           {"effect": "g_sensitivity", "xz": 0.1}]


@pytest.mark.parametrize("effects", [[], EFFECTS], ids=["nominal", "effects"])
def test_what_the_board_keeps_is_what_numpy_counts(tmp_path, effects):
    """Power-up, guided session, capture.bin: every sample in it, exactly."""
    world = worlds.make(dict(SHORT_WORLD, seed=7, warm_c=6.0, effects=effects))
    chip = world.chips[0]
    taken, measure = [], chip.measure

    def listen(k, t_us):
        taken.append(k)
        measure(k, t_us)

    chip.measure = listen
    board = power_on(tmp_path, board=SimulatedBoard(world, tmp_path, (STOP_WHEN_READY,)))
    assert board.only("solved")["verdict"] in ("good", "doubtful")
    chip.measure = measure
    capture = capture_file.read(str(tmp_path / "capture.bin"))
    kept = np.column_stack([capture.accel, capture.gyro, capture.temp])
    simulator.vectorise(world.model)
    k = np.array(taken)
    counted = np.concatenate([simulator.counts(world.model, output, k)
                              for output in simulator.outputs_of(world.chips)]).T
    # The session begins after the self-test: the first sample kept says with which k.
    start = next(i for i in range(len(k)) if (counted[i:i + 5] == kept[:5]).all())
    assert len(kept) > 4000
    assert (counted[start:start + len(kept)] == kept).all()
    if effects:
        assert (kept[:, :3] % 4 == 0).all()  # the effect went through the firmware

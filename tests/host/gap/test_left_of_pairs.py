"""What two logs of one motion leave unexplained: it is the noise of neither."""
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.diagnosis.simulator import single_log


@pytest.mark.parametrize("hz", [0.0, 1.03, 5.5])
def test_what_swings_steadily_at_rest_is_no_noise(hz):
    """8 mg at 1 Hz were 13 times the noise of the simulator, and the gap less than that noise."""
    rng, t = np.random.default_rng(4), np.arange(0.0, 40.0, 0.01)
    values = 0.02 * rng.standard_normal((len(t), 3))
    values[:, 2] += 0.08 * np.sin(2.0 * np.pi * hz * t)
    log = SimpleNamespace(rests=[(k, k + 950) for k in range(0, 4000, 1000)], rate_hz=100.0)
    assert single_log.noise(log, values).density == pytest.approx([0.002] * 3, rel=0.2)

"""A log that is too short for two stretches says how its noise scatters without a warning."""

import warnings

import numpy as np

from sixflip_host.diagnosis.detect import rest_spectra


def test_one_stretch_does_not_tell_how_a_line_scatters():
    noise = np.random.default_rng(3).normal(size=(3, 512, 3))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert rest_spectra.scatter(list(noise[:1]), 0, 40) == 0.0
        assert 0.0 < rest_spectra.scatter(list(noise), 0, 40) < 2.0

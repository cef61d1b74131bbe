"""The first line of a diagnosis says of each axis what is so of it."""
import json
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis import answer
from sixflip_host.diagnosis.diagnose import diagnose
from sixflip_host.planning import next_capture
from sixflip_host.present import gap_sentence


def said(axes, hz):
    cause = {"sensor": "accel", "effect": "vibration", "class": ["vibration"], "axes": axes,
             "hz": hz, "value": dict.fromkeys(axes, 1.5), "unit": "mg", "plausible": True}
    return gap_sentence.sentence({"damage": [], "verdict": "explained", "causes": [cause],
                                  "gap": {}, "unseen": [], "where": []})


def test_a_frequency_is_said_of_the_axes_that_have_it():
    """31.6 Hz was said of an axis that is shaken at 62.8 Hz now and then."""
    assert "31.6 Hz on Z, and at none on Y" in said(["y", "z"], {"z": 31.6})
    assert "frequency, 31.6 Hz, up" in said(["y", "z"], {"y": 31.6, "z": 31.6})
    assert "12.5 Hz on Y, 31.6 Hz on Z, up" in said(["y", "z"], {"y": 12.5, "z": 31.6})
    assert "at no steady frequency" in said(["y"], {})


def test_a_frequency_is_said_with_the_digits_that_it_is_known_to():
    """Six were said of any."""
    cause = {"sensor": "accel", "effect": "vibration", "class": ["vibration"], "axes": ["z"],
             "hz": {"z": 30.299967}, "value": {"z": 1.5}, "unit": "mg", "plausible": True,
             "lines": {"z": {"hz": 30.299967, "interval_90_hz": [30.26, 30.34]}}}
    assert "frequency, 30.30 Hz, 1.5 mg" in gap_sentence.sentence(
        {"damage": [], "verdict": "explained", "causes": [cause], "gap": {}, "unseen": [],
         "where": []})


def moving(seconds, rests):
    """A Capture that swings all the time, or rests for two seconds now and then, in one pose."""
    t = np.arange(int(100 * seconds)) / 100.0
    swing = np.stack([np.sin(2.3 * t), np.sin(3.1 * t + 1.0), np.sin(1.7 * t + 2.0)], axis=1)
    swing *= (t % 10.0 > 2.0)[:, None] if rests else 1.0
    rng = np.random.default_rng(3)
    accel = [0.0, 0.0, 16384.0] + 4000.0 * swing + rng.normal(0.0, 50.0, swing.shape)
    gyro = 5000.0 * swing + rng.normal(0.0, 8.0, swing.shape)
    meta = {"sensor": "mpu6050", "rate_hz": 100.0, "accel_lsb_per_g": 16384.0,
            "gyro_lsb_per_dps": 131.0}
    return Capture(meta, np.rint(1e6 * t).astype(np.int64), np.rint(accel).astype(np.int16),
                   np.rint(gyro).astype(np.int16))


def test_a_verdict_that_cannot_tell_says_why_and_what_to_record():
    """It said of every such capture that most effects would not show in it."""
    told = answer.as_dict(diagnose([("log", moving(20.0, False))]))
    assert told["verdict"] == "cannot tell"
    said = gap_sentence.sentence(told)
    assert "cannot tell: it holds no rest" in said
    assert "To find out, record half a minute at rest before and after the motion." in said
    json.dumps(told)


@pytest.mark.parametrize("one_of, shaken, same, moving, why, record", [
    (("axes", "gyro_unit"), (), True, True, "cannot tell which, between log and sim",
     "every axis"),
    ((), ("gyro",), True, True, "more of the gyro is left between log and sim", "one motion"),
    ((), (), False, True, "gyro scale x are alike in both, but the two logs are of different"
     " motions", "the simulator in the motion of the real log"),
    ((), (), False, False, "neither log moves", "")])
def test_two_logs_that_cannot_tell_say_why(one_of, shaken, same, moving, why, record):
    beside = SimpleNamespace(
        against="log", log="sim", shaken=shaken, alignment=SimpleNamespace(
            same=same, moving=moving), parameters=[
                SimpleNamespace(name="gyro_scale_x", differs=False, difference_interval=moving),
                SimpleNamespace(name="gyro_bias_x", differs=True, difference_interval=moving)],
        conventions=[SimpleNamespace(one_of=one_of, words="it shows one of: axes, gyro_unit; these"
                                     " logs cannot tell which")])
    untold = next_capture.untold(SimpleNamespace(
        comparisons=[beside], causes=[], findings=[], sessions=[], gaps={}))
    assert why in untold["why"] and record in untold["record"]

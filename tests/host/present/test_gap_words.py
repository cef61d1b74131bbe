"""The first line of a diagnosis says of each axis what is so of it."""
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

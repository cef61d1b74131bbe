"""The first line of a diagnosis says of each axis what is so of it."""
from sixflip_host.present import gap_words


def said(axes, hz):
    cause = {"sensor": "accel", "effect": "vibration", "class": ["vibration"], "axes": axes,
             "hz": hz, "value": dict.fromkeys(axes, 1.5), "unit": "mg", "plausible": True}
    return gap_words.sentence({"damage": [], "verdict": "explained", "causes": [cause],
                               "gap": {}, "unseen": [], "where": []})


def test_a_frequency_is_said_of_the_axes_that_have_it():
    """31.6 Hz was said of an axis that is shaken at 62.8 Hz now and then."""
    assert "31.6 Hz on Z, and at none on Y" in said(["y", "z"], {"z": 31.6})
    assert "frequency, 31.6 Hz, up" in said(["y", "z"], {"y": 31.6, "z": 31.6})
    assert "12.5 Hz on Y, 31.6 Hz on Z, up" in said(["y", "z"], {"y": 12.5, "z": 31.6})
    assert "at no steady frequency" in said(["y"], {})

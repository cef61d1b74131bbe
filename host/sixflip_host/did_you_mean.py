"""What was probably meant by a word that is none of those there are."""

import difflib


def closest(word, names):
    """The name that a word resembles, or ""."""
    spelled = {str(name).lower(): str(name) for name in names}
    near = difflib.get_close_matches(str(word).lower(), list(spelled), 1)
    return spelled[near[0]] if near else ""


def instead(word, names, expected="expected one of %s"):
    """"did you mean thermal_bias? expected one of …", without the question where nothing is
    near; to stand behind what was found and a comma."""
    near = closest(word, names)
    asked = "did you mean %s? " % near if near else ""
    return asked + expected % " ".join(str(name) for name in names)

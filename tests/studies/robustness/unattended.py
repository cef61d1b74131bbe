"""Real recordings, unattended: what is said of each, held against what is known of it.

    python -m tests.studies.robustness.unattended

What is known stands in the README of the recordings; nothing is told to the diagnosis but the
files. Exits with 1 when a row does not hold.
"""

import re
import sys

from . import ask, real_captures

XSENS_REST = (0, 5000)  # samples: imu_tk's own test program is told 50 s
TREE_LINE_HZ = (143.0, 167.0)  # half of 333 samples a second
PLACED = {"box_tilt", "table_tilt", "vibration", "quantisation"}


class Heard:
    """answer: the JSON; text: what is printed; of(effect, sensor): its cause or None."""

    def __init__(self, captures):
        self.answer, self.text = ask.diagnose(captures), ask.said(captures)

    def of(self, effect, sensor="accel"):
        found = [c for c in self.answer["causes"]
                 if effect in c["class"] and c["sensor"] == sensor]
        return found[0] if found else None

    def names(self):
        return {name for c in self.answer["causes"] for name in c["class"]}


def size(cause):
    """The largest coefficient, 0 without a cause."""
    return max((abs(v) for v in cause["value"].values()), default=0.0) if cause else 0.0


def steps_of_four(heard):
    cause = heard.of("quantisation")
    return cause is not None and cause["value"] == {"x": 4.0, "y": 4.0, "z": 4.0}


def uneven(heard):
    """Rows that came late, pauses or losses: which of them is a matter of the clock's tests."""
    return any(one["late"]["rows"] or one["pauses"]["number"] or one["losses"]["samples"]
               for one in heard.answer["clock"])


def slope_of_z(heard):
    """Z against temperature at rest: -23.5 counts/degC by straight regression."""
    cause = heard.of("thermal_bias")
    return cause is not None and "z" in cause["axes"] and cause["effect"] is None \
        and abs(cause["value"]["z"] * 16.384 + 23.5) < 3.0


def says_the_line(heard):
    hertz = [float(x) for x in re.findall(r"([0-9]+\.?[0-9]*) Hz", heard.text)]
    return heard.of("vibration") is not None and any(
        TREE_LINE_HZ[0] <= h <= TREE_LINE_HZ[1] for h in hertz)


# name: (captures of the folder, [(what is known, whether it was said)])
ROWS = {
    "Xsens, 38 poses": (
        lambda place: [real_captures.xsens(place)],
        [("g-sensitivity up to 0.155 °/s/g",
          lambda h: 0.14 < size(h.of("g_sensitivity", "gyro")) < 0.17),
         ("and not drift", lambda h: "drift" not in h.names()),
         ("the accelerometer has no cause",
          lambda h: not any(c["sensor"] == "accel" for c in h.answer["causes"]))]),
    "Xsens, 50 s of rest": (
        lambda place: [real_captures.part(real_captures.xsens(place), *XSENS_REST)],
        [("no gap", lambda h: h.answer["verdict"] == "no gap")]),
    "tree, three still files": (
        lambda place: [real_captures.tree(place, n) for n in real_captures.TREE_STILL],
        [("steps of 4", steps_of_four),
         ("Az -23.5 counts/°C, and no single name for it", slope_of_z),
         ("stalls", uneven)]),
    "tree, chainsaw": (
        lambda place: [real_captures.tree(place, "chainsaw_1")],
        [("a line between 143 and 167 Hz", says_the_line)]),
    "tree, machete": (
        lambda place: [real_captures.tree(place, "machete_1")],
        [("shocks to the rail", lambda h: h.of("saturation") is not None)]),
    "Suarez, ten poses": (
        lambda place: [real_captures.suarez(place)],
        [("steps of 4", steps_of_four),
         ("gyro turned beyond its range", lambda h: h.of("saturation", "gyro") is not None)]),
    "imucal, six crooked faces": (
        lambda place: [real_captures.ferraris(place)],
        [("no sensor effect", lambda h: h.names() <= PLACED)]),
    "botlab, driving": (
        lambda place: [real_captures.botlab(place)],
        [("vibration", lambda h: h.of("vibration") is not None),
         ("stalls in the times", uneven)]),
}


def main():
    from sixflip_host.capture import recordings
    place, missed = recordings.folder(), 0
    for name, (captures, known) in ROWS.items():
        heard = Heard(captures(place))
        print("%s: %s" % (name, ask.brief(heard.answer)))
        for what, holds in known:
            missed += not holds(heard)
            print("    %-48s %s" % (what, "said" if holds(heard) else "NOT SAID"))
        for remark in heard.answer["remarks"]:
            print("    (%s)" % remark)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())

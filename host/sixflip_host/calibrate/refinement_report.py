"""The answer of `sixflip refine` for a person."""

import math

from ..terminal import console, plain, table, verdict_text


def show(found):
    """Print a refinement's dictionary (refine.assemble)."""
    out = console()
    out.print(plain("%d rests (%s), %d moves" % (
        found["rests"], found["rests_from"], found["moves"])))
    for line in found["moves_left_out"]:
        out.print(plain("  left out: " + line))
    out.print(_accelerometer(found))
    _gyro(out, found)
    if found["flips"]:
        out.print(_flips(found))
    if found["solved"] is not None:
        out.print(plain("solved by this session: %s" % (", ".join(found["solved"]) or "nothing")))
        out.print(plain("kept from the record: %s" % (", ".join(found["kept"]) or "nothing")))
    elif found["not_determined"] and found["verdict"] != "refused":
        out.print(plain("hardly told by this session: %s" % ", ".join(found["not_determined"])))
    out.print(verdict_text(found["verdict"]),
              plain(found["reason"] and ": " + found["reason"]), sep="")


def _accelerometer(found):
    accel = found["accel"]
    sigma, mg = accel["sigma"], 1e3 / found["g"]
    rows = [[axis, "%.5f ± %.5f" % (accel["scale"][k], sigma["scale"][k]),
             "%+.2f ± %.2f" % (-mg * accel["v"][k], mg * sigma["v"][k]),
             "  ".join("%+.3f" % math.degrees(accel["T"][k][j]) for j in range(3) if j != k)]
            for k, axis in enumerate("xyz")]
    return table("accelerometer, %d terms; |a| - g %.3f mg rms over the rests" % (
        accel["terms"], found["norm_off_mg_rms"]),
        ["axis", "scale", "bias, mg", "angles, deg"], rows)


def _gyro(out, found):
    gyro = found["gyro"]
    if gyro is None:
        out.print(plain(found.get("gyro_missing", "gyro: no move could be used")))
        return
    out.print(table(
        "gyro; gravity at both ends of the moves agrees to %.3f deg rms"
        % found["moves_off_deg_rms"], ["axis", "scale", "from moves alone", "bias, deg/s"],
        [[axis, "%.5f ± %.5f" % (gyro["P"][k][k], gyro["sigma"]["P"][k][k]),
          "%.5f ± %.5f" % (gyro["scale_from_moves"][k], gyro["scale_from_moves_sigma"][k]),
          "%+.4f" % gyro["bias_dps"][k]] for k, axis in enumerate("xyz")]))
    if gyro["per_g_dps"]:
        out.print(table(
            "pulled by gravity, deg/s a g on x y z", ["axis", "x", "y", "z"],
            [[axis, *("%+.4f ± %.4f" % pair for pair in zip(row, sigma))] for axis, row, sigma in
             zip("xyz", gyro["per_g_dps"], gyro["per_g_sigma_dps"])]))


def _flips(found):
    title = "flips, a to b about the face's own axis"
    if found["flip_spread_deg"] is not None:
        title += " (the hand's spread about 180: %.2f deg)" % found["flip_spread_deg"]
    rows = []
    for face, flip in found["flips"].items():
        known = flip["sigma_deg"] is not None
        rows.append([face, "%.2f ± %.2f" % (flip["angle_deg"], flip["sigma_deg"])
                     if known else "180", "! " + flip["reason"] if known and flip["off"]
                     else "" if known else flip["reason"]])
    return table(title, ["face", "turned, deg", "remark"], rows, prose=True)

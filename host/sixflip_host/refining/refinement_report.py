"""The answer of `sixflip refine` for a person."""


def lines(found):
    """Lines of text of a refinement's dictionary (refine.assemble)."""
    out = ["%d rests (%s), %d moves" % (found["rests"], found["rests_from"], found["moves"])]
    out += ["  left out: " + line for line in found["moves_left_out"]]
    out += _accelerometer(found) + _gyro(found) + _flips(found)
    if found["solved"] is not None:
        out.append("solved by this session: %s" % (", ".join(found["solved"]) or "nothing"))
        out.append("kept from the record: %s" % (", ".join(found["kept"]) or "nothing"))
    elif found["not_determined"] and found["verdict"] != "refused":
        out.append("hardly told by this session: %s" % ", ".join(found["not_determined"]))
    out.append("%s%s" % (found["verdict"], found["reason"] and ": " + found["reason"]))
    return out


def _accelerometer(found):
    accel = found["accel"]
    sigma = accel["sigma"]
    out = ["accelerometer, %d terms (T S (a + v)); |a| - g %.3f mg rms over the rests"
           % (accel["terms"], found["norm_off_mg_rms"])]
    for k, axis in enumerate("xyz"):
        out.append("  %s  scale %.5f ± %.5f   v %+.4f ± %.4f m/s²   T %s" % (
            axis, accel["scale"][k], sigma["scale"][k], accel["v"][k], sigma["v"][k],
            " ".join("%+.5f" % t for t in accel["T"][k])))
    return out


def _gyro(found):
    gyro = found["gyro"]
    if gyro is None:
        return [found.get("gyro_missing", "gyro: no move could be used")]
    out = ["gyro; gravity at both ends of the moves agrees to %.3f deg rms"
           % found["moves_off_deg_rms"]]
    for k, axis in enumerate("xyz"):
        out.append("  %s  scale %.5f ± %.5f (from moves alone %.5f ± %.5f)   bias %+.4f deg/s" % (
            axis, gyro["P"][k][k], gyro["sigma"]["P"][k][k], gyro["scale_from_moves"][k],
            gyro["scale_from_moves_sigma"][k], gyro["bias_dps"][k]))
    if gyro["per_g_dps"]:
        out.append("  pulled by gravity, deg/s a g on x y z:")
        for axis, row, sigma in zip("xyz", gyro["per_g_dps"], gyro["per_g_sigma_dps"]):
            out.append("  %s  %s" % (axis, "   ".join(
                "%+.4f ± %.4f" % pair for pair in zip(row, sigma))))
    return out


def _flips(found):
    if not found["flips"]:
        return []
    out = ["flips, a to b about the face's own axis"]
    if found["flip_spread_deg"] is not None:
        out[0] += " (the hand's spread about 180: %.2f deg)" % found["flip_spread_deg"]
    for face, flip in found["flips"].items():
        if flip["sigma_deg"] is None:
            out.append("  %s  180 (%s)" % (face, flip["reason"]))
        else:
            out.append("  %s  %.2f ± %.2f deg%s" % (
                face, flip["angle_deg"], flip["sigma_deg"],
                "   ! " + flip["reason"] if flip["off"] else ""))
    return out

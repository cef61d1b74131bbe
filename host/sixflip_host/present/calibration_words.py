"""A solved or a refined capture in words and tables."""

import math

from sixflip.poses.faces import FACES, pose_name

from ..calibrate.solution import middles_mg
from ..terminal import console, plain, styled, table, verdict_text


def show(solution):
    """Print everything a person wants to know; the verdict first and last."""
    screen = console()
    capture = solution.capture
    samples = "%d samples, " % len(capture) if len(capture) else ""
    screen.print(plain("%s: %s%d still poses" % (
        capture.meta["sensor"], samples, len(solution.placements))))
    for remark in solution.remarks:
        screen.print(plain("  " + remark))
    if solution.accel:
        screen.print(parameters(solution))
        screen.print(poses(solution))
        screen.print("middle: half-way between the axis' two faces, as read; angles: to the "
                     "others")
        screen.print(plain(tilt_line(solution.accel)))
    for line in solution.flips.words():
        screen.print(plain(line))
    if solution.gyro:
        screen.print(gyro_table(solution.gyro))
        if solution.gyro.flips:
            screen.print(flip_table(solution.gyro, solution.flips))
        screen.print("gyro: ", verdict_text(solution.gyro.verdict), plain(
            ": " + solution.gyro.reason), sep="")
    else:
        screen.print(plain("gyro: not calibrated: " + solution.no_gyro))
    screen.print(verdict_text(solution.verdict), ": ", plain(solution.reason), sep="")


def parameters(solution):
    """The table of parameter_rows."""
    return table("accelerometer (%s)" % solution.accel.level, *parameter_rows(solution))


def parameter_rows(solution):
    """Scale, offset and small angles of every axis with their standard errors: head, rows."""
    r = solution.accel
    middles = middles_mg(solution.placements, solution.capture.meta["accel_lsb_per_g"])
    rows = []
    for k in range(3):
        angles = [math.degrees(r.T[k][j]) for j in range(3) if j != k]
        rows.append([
            "xyz"[k], "%.5f ± %.5f" % (r.scale[k], r.sigma_scale[k]),
            "%+.2f ± %.2f" % (-1e3 * r.v[k] / r.g, 1e3 * r.sigma_v[k] / r.g),
            "-" if middles[k] is None else "%+.1f" % middles[k],
            "%+.3f  %+.3f" % tuple(angles)])
    return ["axis", "scale", "bias, mg", "middle, mg", "angles, deg"], rows


def poses(solution):
    """The table of pose_rows."""
    return table("what is left over", *pose_rows(solution))


def pose_rows(solution):
    """Every pose with its noise and what the solve leaves over: head, rows."""
    r = solution.accel
    lsb = solution.capture.meta["accel_lsb_per_g"]
    rows = []
    for code in sorted(r.residual):
        mine = [one for one in solution.placements if one.pose == code]
        noise = max(max(one.noise[:3]) for one in mine)
        left = [1e3 * x for x in r.residual[code]]
        size = math.sqrt(sum(x * x for x in left))
        rows.append([pose_name(code), str(sum(one.n for one in mine)),
                     "%.2f" % (1e3 * noise / lsb), "  ".join("%+7.2f" % x for x in left),
                     styled("%.2f" % size, "yellow" if size > 2 else "")])
    return ["pose", "samples", "noise, mg", "residual x y z, mg", "length"], rows


def tilt_line(r):
    """The table's tilt in a sentence."""
    if r.tilt_deg is None:
        return "table tilt unknown: no face was turned by 180 degrees"
    return "table tilt %.3f deg, the faces agree to %.3f deg" % (r.tilt_deg, r.tilt_spread_deg)


def gyro_table(gyro):
    """The table of gyro_rows."""
    return table("gyro", *gyro_rows(gyro))


def gyro_rows(gyro):
    """Scale, bias and small angles of every axis: head, rows."""
    A = [[gyro.P[j][k] for j in range(3)] for k in range(3)]
    rows = []
    for k in range(3):
        scale = "%.5f ± %.5f" % (A[k][k], gyro.sigma[k][k])
        angles = "%+.3f  %+.3f" % tuple(
            math.degrees(A[k][j] / A[j][j]) for j in range(3) if j != k)
        if k in gyro.missing:  # the matrix from before, or the data sheet's, stands there
            scale, angles = "%.5f, not measured" % A[k][k], "-"
        rows.append(["xyz"[k], scale, "%+.4f ± %.4f" % (gyro.bias_dps[k], gyro.sigma_bias_dps[k]),
                     angles])
    return ["axis", "scale", "bias, deg/s", "angles, deg"], rows


def flip_table(gyro, turned):
    """The table of flip_rows."""
    return table("flips", *flip_rows(gyro, turned))


def flip_rows(gyro, turned):
    """Every flip: the angle by the solved gyro and by the moves, and why it does not count."""
    rows = []
    for face, flip in gyro.flips.items():
        by_moves = turned.measured.get(FACES.index(face))
        rows.append([face, "%.2f" % flip["angle_deg"],
                     "%.2f ± %.2f" % by_moves if by_moves else "-",
                     "yes" if flip["used"] else "no", flip["reason"]])
    return ["face", "turned, deg", "by the moves, deg", "used", "why not"], rows


def show_refinement(refined):
    """Print the dictionary of refinement.refine."""
    screen = console()
    screen.print(plain("%d rests (%s), %d moves" % (
        refined["rests"], refined["rests_from"], refined["moves"])))
    for line in refined["moves_left_out"]:
        screen.print(plain("  left out: " + line))
    screen.print(_refined_accelerometer(refined))
    _refined_gyro(screen, refined)
    if refined["flips"]:
        screen.print(_refined_flips(refined))
    if refined["solved"] is not None:
        screen.print(plain("solved by this session: %s" % (
            ", ".join(refined["solved"]) or "nothing")))
        screen.print(plain("kept from the record: %s" % (", ".join(refined["kept"]) or "nothing")))
    elif refined["not_determined"] and refined["verdict"] != "refused":
        screen.print(plain("hardly told by this session: %s" % ", ".join(
            refined["not_determined"])))
    screen.print(verdict_text(refined["verdict"]),
                 plain(refined["reason"] and ": " + refined["reason"]), sep="")


def _refined_accelerometer(refined):
    accel = refined["accel"]
    sigma, mg = accel["sigma"], 1e3 / refined["g"]
    rows = [[axis, "%.5f ± %.5f" % (accel["scale"][k], sigma["scale"][k]),
             "%+.2f ± %.2f" % (-mg * accel["v"][k], mg * sigma["v"][k]),
             "  ".join("%+.3f" % math.degrees(accel["T"][k][j]) for j in range(3) if j != k)]
            for k, axis in enumerate("xyz")]
    return table("accelerometer, %d terms; |a| - g %.3f mg rms over the rests" % (
        accel["terms"], refined["norm_off_mg_rms"]),
        ["axis", "scale", "bias, mg", "angles, deg"], rows)


def _refined_gyro(screen, refined):
    gyro = refined["gyro"]
    if gyro is None:
        screen.print(plain(refined.get("gyro_missing", "gyro: no move could be used")))
        return
    screen.print(table(
        "gyro; gravity at both ends of the moves agrees to %.3f deg rms"
        % refined["moves_off_deg_rms"], ["axis", "scale", "from moves alone", "bias, deg/s"],
        [[axis, "%.5f ± %.5f" % (gyro["P"][k][k], gyro["sigma"]["P"][k][k]),
          "%.5f ± %.5f" % (gyro["scale_from_moves"][k], gyro["scale_from_moves_sigma"][k]),
          "%+.4f" % gyro["bias_dps"][k]] for k, axis in enumerate("xyz")]))
    if gyro["per_g_dps"]:
        screen.print(table(
            "pulled by gravity, deg/s a g on x y z", ["axis", "x", "y", "z"],
            [[axis, *("%+.4f ± %.4f" % pair for pair in zip(row, sigma))] for axis, row, sigma in
             zip("xyz", gyro["per_g_dps"], gyro["per_g_sigma_dps"])]))


def _refined_flips(refined):
    title = "flips, a to b about the face's own axis"
    if refined["flip_spread_deg"] is not None:
        title += " (the hand's spread about 180: %.2f deg)" % refined["flip_spread_deg"]
    rows = []
    for face, flip in refined["flips"].items():
        known = flip["sigma_deg"] is not None
        rows.append([face, "%.2f ± %.2f" % (flip["angle_deg"], flip["sigma_deg"])
                     if known else "180", "! " + flip["reason"] if known and flip["off"]
                     else "" if known else flip["reason"]])
    return table(title, ["face", "turned, deg", "remark"], rows, prose=True)

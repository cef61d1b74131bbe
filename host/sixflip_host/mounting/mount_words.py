"""A mounting in lines for a person."""

RULE = "|√(Gy²+Gz²)-1| = %.4f %s |√(Gx²+Gz²)-1| = %.4f"
CHAIN = ("the sensor is corrected first, then turned: measured = (I+S+M) R a + b; the paper's "
         "chain R (I+S+M) a + b puts its errors before the rotation")


def lines(found, both=False):
    """What `sixflip mount` prints."""
    out = ["G = (%+.4f, %+.4f, %+.4f) g, length %.4f g%s" % (
        *found["G"], found["G_size"], "" if found["calibrated"] else
        ": not calibrated, its direction alone is used")]
    rest = found["rest"]
    if rest:
        out.append("  %d samples at rest, noise %.2f mg: the angles are good to %.3f deg by "
                   "noise alone" % (rest["samples"], rest["noise_mg"], rest["angle_sigma_deg"]))
        if not found["calibrated"]:
            out.append("  without --record the sensor's bias is in the angles: 10 mg are 0.6 deg")
    rule = found["rule"]
    out.append("paper's rule: R_%s, since %s" % (
        rule["order"], RULE % (rule["left"], "<" if rule["left"] < rule["right"] else ">=",
                               rule["right"])))
    orders = ("xyz", "yxz") if both else (found["order"],)
    for order in orders:
        one = found["both"][order]
        out.append("order R_%s: roll %.4f deg, pitch %.4f deg, yaw 0 (gravity does not show it)"
                   "%s" % (order, one["roll_deg"], one["pitch_deg"],
                           " <- taken" if both and order == found["order"] else ""))
    out.append("axes: the robot's x y z lie along the sensor's %s%s" % (
        found["axes"], "; the answer is in NED: forward, right, down"
        if found["frame"] == "ned" else ""))
    if found["left_handed"]:
        out.append("  the axes asked for are left-handed, no way of mounting gives that: roll and "
                   "pitch are for y turned round; rates need the matrix with its sign turned")
    out.append("robot = C · sensor, C (order R_%s)" % found["order"])
    out += ["  %+.6f  %+.6f  %+.6f" % tuple(row) for row in found["compensation"]]
    out.append("G in the robot's axes: (%+.4f, %+.4f, %+.4f) g" % tuple(found["G_robot"]))
    out.append(CHAIN + ("; with this sensor's errors that is %.1f mg"
                        % found["chain_differs_mg"] if found["chain_differs_mg"] is not None
                        else ", 10.6 mg at 30 and 15 deg with scale errors of +2, +0.5, -1 %"))
    return out

"""Good, doubtful or refused, and the sentence that says why: the gyro."""

SCALE_OFF = 0.2
ANGLE_OFF_DEG = 3.0
ACROSS_DEG = 1.5  # half of what two flips of an axis may lean apart


def judge_gyroscope(r):
    """("good" | "doubtful" | "refused", sentence) about a GyroscopeResult; NaN never passes."""
    if r.wrong_axes:
        return "refused", r.wrong_axes
    for row in r.P:
        for x in row:
            if not abs(x) < 1e6:
                return "refused", "the solve did not end in finite numbers"
    for k in range(3):
        if not abs(r.P[k][k] - 1.0) <= SCALE_OFF:
            return "refused", ("gyro scale of axis %s is %.3f, 0.8 to 1.2 is the limit: wrong "
                               "range or LSB?" % ("xyz"[k], r.P[k][k]))
    out = ["%s (%s)" % (face, r.flips[face]["reason"]) for face in sorted(r.flips)
                if not r.flips[face]["used"]]
    more = "; left out: " + ", ".join(out) if out else ""
    unseen = ["xyz"[k] for k in range(3) if k not in r.signs_seen]
    if unseen:
        more += "; sign of %s not seen, no quarter turn about it" % " and ".join(unseen)
    if len(r.missing) == 3:
        return "refused", "no usable flip about any axis" + more
    if r.missing:
        return "doubtful", ("no usable flip about axis %s, its old values are kept"
                            % " and ".join(["xyz"[k] for k in r.missing])) + more
    for face in sorted(r.flips):
        angle = r.flips[face]["angle_deg"]
        if r.flips[face]["used"] and not abs(angle - 180.0) <= ANGLE_OFF_DEG:
            return "doubtful", ("the flips of an axis disagree: %s turned by %.1f degrees if "
                                "the others were half turns, 3 is the limit" % (face, angle))
    if not r.across_deg <= ACROSS_DEG:
        return "doubtful", ("the flips of an axis disagree: one of them turned by %.1f degrees "
                            "about another axis, %.1f is the limit" % (r.across_deg, ACROSS_DEG))
    # One flip is right or wrong by itself: late or repeated samples may have shortened it.
    unseen = [k for k in "XYZ" if len([1 for face in r.flips if face[0] == k
                                       and r.flips[face]["used"]]) < 2]
    if unseen:
        return "doubtful", ("one flip alone about %s, nothing to hold its angle against"
                            % " and ".join(unseen).lower()) + more
    scale = max([r.sigma[k][k] for k in range(3)])
    if not scale <= 0.01:
        return "doubtful", "the scale is known to %.1f %% only, 1 is the limit" % (100 * scale)
    used = len([1 for face in r.flips if r.flips[face]["used"]])
    return "good", ("%d flips, scale known to %.2f %%, bias to %.3f degrees/s"
                    % (used, 100 * scale, max(r.sigma_bias_dps))) + more

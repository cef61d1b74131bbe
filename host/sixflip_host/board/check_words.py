"""The answer of `sixflip check` in lines for a person."""

from ..terminal import plain


def lines(found):
    """What is printed: each number beside the record's, then still valid or not and why."""
    out = []
    if found["a_error_mg"] is not None:
        out.append("|a|          %+.2f mg off gravity (length only: it says nothing of "
                   "directions)" % found["a_error_mg"])
    out += _beside("noise", found["noise_mg"], found["noise_then_mg"], "%.2f mg")
    out += _beside("temperature", found["temp_c"], found["temp_then_c"], "%.1f °C")
    if found["bias_dps"]:
        form = "%+.3f %+.3f %+.3f deg/s"
        then = found["bias_then_dps"]
        out += _beside("gyro bias", tuple(found["bias_dps"]), then and tuple(then), form)
    if found["record_verdict"] == "doubtful":
        out.append(plain("the calibration itself was doubtful: %s" % found["record_reason"]))
    if found["valid"]:
        out.append("still valid: nothing speaks against the record")
    else:
        out.append("no longer valid:")
        out += ["  " + plain(one) for one in found["against"]]
    return out


def _beside(name, now, then, form):
    if now is None:
        return []
    return ["%-12s " % name + form % now
            + ("" if then is None else ", at the calibration " + form % then)]

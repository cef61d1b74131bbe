"""A record's terms as JSON and in words."""

SENSOR = {"a": "accelerometer", "g": "gyro"}
WHAT = {"accel_thermal_bias": ("drift with temperature", "mg/°C"),
        "gyro_thermal_bias": ("drift with temperature", "°/s/°C"),
        "accel_thermal_scale": ("scale with temperature", "%/°C"),
        "gyro_thermal_scale": ("scale with temperature", "%/°C"),
        "g_sensitivity": ("sensitivity to gravity", "°/s/g")}


def facts(name, fields):
    """dict: term, sensor, unit, value and sigma by axis ("x", "x2" for the square, "xy" for what
    1 g along y does to rate x), between (°C), about (°C), gain; origin and source."""
    value, sigma = {}, {}
    if name == "g_sensitivity":
        for i in fields["axes"]:
            for j in range(3):
                value["xyz"[i] + "xyz"[j]] = fields["k"][i][j]
                sigma["xyz"[i] + "xyz"[j]] = fields["sigma"][i][j]
    else:
        for power in ("k1", "k2"):
            for i in fields["axes"]:
                if fields.get(power, (0.0,) * 3)[i]:
                    key = "xyz"[i] + power[1:].replace("1", "")
                    value[key], sigma[key] = fields[power][i], fields["sigma_" + power][i]
    answer = {"term": name, "sensor": SENSOR[name[0]], "unit": WHAT[name][1], "value": value,
              "sigma": sigma, "origin": fields["origin"], "source": fields["source"],
              "gain": {"unit": "mg" if name[0] == "a" else "°/s",
                       **{key: fields[key] for key in ("before", "after", "floor")}}}
    if name != "g_sensitivity":
        answer.update(between_c=[fields["low_c"], fields["high_c"]], about_c=fields["t0_c"])
    return answer


def lines(facts):
    """[str] about one facts()."""
    sizes = ", ".join("%s %+.3g%s" % (key, value, "" if facts["sigma"][key] is None else
                                      " ± %.2g" % facts["sigma"][key])
                      for key, value in facts["value"].items())
    text = "%s, %s: %s %s" % (WHAT[facts["term"]][0], facts["sensor"], sizes or "none",
                              facts["unit"])
    if any(key.endswith("2") for key in facts["value"]):
        text += " (2: per °C²)"
    if "between_c" in facts:
        text += ", measured at %.1f to %.1f °C (about %.1f)" % (
            *facts["between_c"], facts["about_c"])
    gain = facts["gain"]
    out = [text, "  from %s (%s)" % (facts["source"] or "unknown captures", facts["origin"])]
    if gain["before"] is not None and gain["after"] is not None:
        out[1] += ": %.3g %s before, %.3g after%s" % (
            gain["before"], gain["unit"], gain["after"],
            "" if gain["floor"] is None else ", noise alone %.3g" % gain["floor"])
    return out

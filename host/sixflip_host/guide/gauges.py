"""The live numbers of a State as lines: vector, rate, noise against its limit, the capture."""

from rich.text import Text

from .next_step import instead, noise_share


def bar(share, width, full="█", empty="░"):
    """A bar of so many characters; share 0 to 1."""
    done = int(round(max(0.0, min(1.0, share)) * width))
    return full * done + empty * (width - done)


def swing(value, most, width):
    """A mark on a line with its zero in the middle."""
    half = width // 2
    at = half + int(round(max(-1.0, min(1.0, value / most)) * half))
    line = ["·"] * (2 * half + 1)
    line[half] = "│"
    line[at] = "█"
    return "".join(line)


def measured(state):
    """Vector, rate, noise against its limit, the bar of the capture: five lines."""
    lines = []
    for k in range(3):
        line = " %s  " % "xyz"[k]
        line += "%+7.3f g  %s" % (state.vector[k], swing(state.vector[k], 1.0, 30)) \
            if state.vector else "      - g"
        if state.rate:
            line = line.ljust(50) + "%+6.0f deg/s  %s" % (state.rate[k],
                                                          swing(state.rate[k], 250.0, 14))
        lines.append(Text(line))
    lines.append(noise(state))
    lines.append(capture(state))
    return lines


def noise(state):
    size = " |a|  %.3f g" % sum(v * v for v in state.vector) ** 0.5 if state.vector else \
        " |a|      - g"
    share = noise_share(state)
    if share:
        over = share[0] > share[1]
        said = Text("%.3g, limit %.0f x the sensor's own [%s]%s" % (
            *share, bar(share[0] / share[1], 12), " too much" if over else ""),
            "red" if over else "")
    else:
        cause = instead(state)
        said = Text("%s: %.3g, limit %.3g %s" % (cause, state.value, state.limit, state.unit)
                    if cause else "-")
    return Text(size + "  noise ") + said


def capture(state):
    if state.box != "capturing":
        return Text(" capture  -")
    share = state.progress / max(1, state.total)
    return Text(" capture  [%s] %3d %%  still %.1f s" % (bar(share, 36), 100 * share,
                                                         state.left_s), "bold")

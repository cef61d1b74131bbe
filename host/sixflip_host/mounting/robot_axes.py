"""The robot's axes as its maker names them: rep103, ned, or where each axis of it points.

x=-y,y=x,z=z says: the robot's x axis lies along the sensor's -y, its y along the sensor's x,
its z along the sensor's z. The names of the shared module mounting.py are the same signed
permutation as "-y x z" and the frame of the answer.
"""

from sixflip.record.mounting import parse_axes

from ..errors import UsageError

EXPECTED = "rep103, ned, or x, y and z once each with its sign, such as x=-y,y=x,z=z"


class RobotAxes:
    """axes: "-y x z"; frame: "rep103" or "ned", as in a record's mounting section.

    left_handed: the maker's axes are a mirror image. Then axes is the right-handed set with
    the robot's y turned round, `mirror` its signs, and `asked` what the maker named.
    """

    def __init__(self, axes="x y z", frame="rep103", left_handed=False, asked=None):
        self.axes = axes
        self.asked = asked or axes
        self.frame = frame
        self.left_handed = left_handed
        self.mirror = (1, -1, 1) if left_handed else (1, 1, 1)


def parse(text):
    """RobotAxes of what stands behind --axes; UsageError for anything else."""
    word = text.strip().lower()
    if word in ("rep103", "ned"):
        return RobotAxes(frame=word)
    named = {}
    for part in word.replace(" ", "").split(","):
        robot, equal, sensor = part.partition("=")
        if not equal or robot not in ("x", "y", "z") or robot in named \
                or sensor.lstrip("+-") not in ("x", "y", "z") or len(sensor) > 2:
            raise UsageError("--axes %s: expected %s" % (text, EXPECTED))
        named[robot] = sensor.lstrip("+")
    if sorted(named) != ["x", "y", "z"] \
            or sorted(one[-1] for one in named.values()) != ["x", "y", "z"]:
        raise UsageError("--axes %s: expected %s" % (text, EXPECTED))
    axes = " ".join(named[robot] for robot in "xyz")
    try:
        parse_axes(axes)
        return RobotAxes(axes)
    except ValueError:
        # The names and signs are right: what is left is the hand.
        y = named["y"]
        named["y"] = y[1:] if y.startswith("-") else "-" + y
        return RobotAxes(" ".join(named[robot] for robot in "xyz"), left_handed=True, asked=axes)

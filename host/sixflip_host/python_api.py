"""The verbs for a program: captures in, values out, nothing printed and no file written.

Every function takes captures as paths or as capture_file.Capture, and hands back a frozen value
with the same figures as the verb's --json, whose dictionary is kept in `json`. What is wrong
with a file or an argument raises BadFile or UsageError (sixflip_host.errors), whose text is the
sentence that the command prints.

numpy and scipy are loaded by the first call, not by importing sixflip_host.
"""

import copy
import os
from dataclasses import dataclass, fields
from types import MappingProxyType

from .errors import BadFile, UsageError


@dataclass(frozen=True)
class Cause:
    """One cause of the gap.

    sensor    accel, gyro or device
    axes      the axes it was seen on, () for effects without
    effect    its name, None where several effects would do the same
    aliased_with   all names that this capture cannot tell apart, its own among them
    value, interval_90   {axis: size}, {axis: (low, high)} in `unit`
    share     of the explainable gap that it closes, None where none was held out
    """

    sensor: str
    axes: tuple
    effect: str
    aliased_with: tuple
    value: dict
    interval_90: dict
    unit: str
    score_nats: float
    share: float
    plausible: bool


@dataclass(frozen=True)
class Diagnosis:
    """Where simulated and real sensor part ways (the JSON of GAP in words).

    verdict   no gap, explained, partly explained, unexplained or cannot tell
    causes    tuple of Cause, the largest first
    gap       {sensor: {unit, before, after, floor, explained_share, interval_90}}
    localisation, undetected, next_captures   tuples of dictionaries: where the gap was seen, what
              these captures cannot show, and the captures that would
    remarks   sentences about the captures
    json      all of it, as `sixflip diagnose --json` prints it
    """

    verdict: str
    causes: tuple
    gap: dict
    localisation: tuple
    undetected: tuple
    next_captures: tuple
    remarks: tuple
    json: dict

    def __str__(self):
        from .present import gap_sentence
        return gap_sentence.sentence(self.json)


@dataclass(frozen=True)
class Solution:
    """A calibration from one capture.

    verdict, reason   good, doubtful or refused, and why
    accelerometer     (4, 4) matrix P for row vectors, m/s²: [ax ay az 1] P is the specific force
                      and 1, where a is what the data sheet's scale makes of the counts (Li 2019,
                      Eq. 6-7); None where the poses do not determine it
    gyro              (4, 3) matrix likewise, rad/s: [wx wy wz 1] P; None without one
    remarks           sentences about the capture
    json              as `sixflip solve --json` prints it
    """

    verdict: str
    reason: str
    accelerometer: object
    gyro: object
    remarks: tuple
    json: dict


@dataclass(frozen=True)
class Plan:
    """What a protocol could tell, before anything is captured.

    silent     effects that leave no residual, as (sensor, effect)
    smallest   {(sensor, effect): smallest size seen with 80 % power, in `unit` of json}
    additions  dictionaries of poses to add, the most telling a minute first
    json       as `sixflip plan --json` prints it
    """

    silent: tuple
    smallest: dict
    additions: tuple
    json: dict


def diagnose(captures, simulator=None, reference=None, certified_box=False, without=(),
             jobs=1):
    """The Diagnosis of one capture or several, a session each.

    captures   a path or Capture, or a sequence of them
    simulator  captures of your own simulator, likewise: the gap to it, not to the nominal one
    reference  a capture at rest, to know the noise by
    certified_box  the box is known to be square
    without    names of effects to leave out of the library
    jobs       processors, 0: all; with more than one, copies of this process do a part (Linux)
    """
    from .diagnosis import answer, diagnose
    diagnosed = diagnose.diagnose(_named(captures or ()), _named(simulator, gravity=False),
                                  _named(reference),
                                  certified_box, without, jobs)
    said = answer.as_dict(diagnosed)
    return Diagnosis(said["verdict"], tuple(_cause(cause) for cause in said["causes"]),
                     _frozen(said["gap"]), _rows(said["where"]), _rows(said["unseen"]),
                     _rows(said["next"]), tuple(said["remarks"]), _frozen(said))


def solve(capture, g=None, level=None):
    """The Solution of one capture by the code that runs on the board.

    g      local gravity, m/s² (default: what the capture says)
    level  of sixflip.accelerometer.six_faces.LEVELS (default: the best that the poses allow)
    """
    import numpy as np

    from .calibrate import solution, solution_json
    from .json_numbers import finite
    (_, read), *more = _named(capture)
    if more:
        raise UsageError("%d captures: expected one" % (1 + len(more)))
    solved = solution.solve(copy.copy(read), g, level)
    said = finite(solution_json.to_json(solved))

    def matrix(result):
        if result is None:
            return None
        values = np.array(result.P, dtype=float)
        values.flags.writeable = False
        return values
    return Solution(solved.verdict, solved.reason, matrix(solved.accel), matrix(solved.gyro),
                    tuple(solved.remarks), _frozen(said))


def plan(protocol="recommended", sensor="mpu6050", certified_box=False, rate_hz=100.0,
         minutes=None):
    """The Plan of a protocol: a name (paper, recommended, ...) or the path of a plan file."""
    from .planning import plan_answer, plan_file, protocols
    if protocol in protocols.STILL:
        planned = protocols.named(protocol)
    elif os.path.exists(protocol):
        planned = plan_file.read(protocol)
    else:
        raise UsageError("%s: expected one of %s, or a plan file"
                         % (protocol, ", ".join(protocols.STILL)))
    said, _ = plan_answer.planned(planned, sensor, certified_box, rate_hz, minutes)
    effects = said["effects"]
    return Plan(tuple((effect["sensor"], effect["effect"]) for effect in effects
                      if effect["silent"]),
                _frozen({(effect["sensor"], effect["effect"]): effect["smallest"]
                         for effect in effects if effect["smallest"] is not None}),
                _rows(said["additions"]), _frozen(said))


def simulate(scenario):
    """Captures of a scenario, one a session: a path of a scenario file, or its dictionary."""
    from .simulation import scenario as scenarios
    from .simulation import simulated_session
    try:
        what = scenarios.from_dict(scenario) if isinstance(scenario, dict) \
            else scenarios.read(scenario)
        return [simulated_session.session(what, number) for number in range(len(what.worlds))]
    except ValueError as error:
        raise BadFile("scenario: %s" % error) from None


def _named(captures, gravity=True):
    """[(name, Capture)] of a path, a Capture, or a sequence of them; [] of None. A path may be
    of a foreign file, which without `gravity` may leave gravity out."""
    from .capture import capture_file, open_recording
    if captures is None:
        return []
    if isinstance(captures, (str, os.PathLike, capture_file.Capture)):
        captures = [captures]
    if not len(captures):
        raise UsageError("no captures: expected one, or a sequence of them")
    return [("capture %d" % number, item) if isinstance(item, capture_file.Capture)
            else (os.fspath(item), open_recording.read_samples(item, gravity))
            for number, item in enumerate(captures, 1)]


def _cause(said):
    known = dict(said, aliased_with=tuple(said["class"]), axes=tuple(said["axes"]),
                 value=_frozen(said["value"]), interval_90=_frozen(said["interval_90"]))
    return Cause(**{field.name: known[field.name] for field in fields(Cause)})


def _rows(values):
    return tuple(_frozen(value) for value in values)


def _frozen(value):
    """A dictionary that cannot be changed."""
    return MappingProxyType(value)

"""Everything that a board may say: its events, its answers to our scripts. Units as in the names.

A board is untrusted: it may be of another version, broken, somebody else's, or at the end of a
cable that damages what it says. Whatever a consumer sees has been through one of these tables.
A field that the firmware emits and no table lists is left out; a test reads the firmware's source
for such fields.
"""

from ..value_kinds import (
    Either,
    Fields,
    Flag,
    Json,
    ListOf,
    MapOf,
    Misfit,
    Nothing,
    Number,
    Octets,
    OneOf,
    Pose,
    Row,
    Text,
)

TEXT, FLAG, NUMBER, POSE = Text(), Flag(), Number(), Pose()
COUNT = Number(0, 1 << 53, whole=True)
ERRNO = Number(-(1 << 16), 1 << 16, whole=True)
SECONDS = Number(0, 1e6)
BYTE = Number(0, 255, whole=True)
NUMBERS, TEXTS, POSES = ListOf(NUMBER), ListOf(TEXT), ListOf(POSE)
THREE = Row(*[Either(NUMBER, Nothing())] * 3)       # one of three may be unknown
VECTOR = Row(NUMBER, NUMBER, NUMBER)
RAW = Row(*[Number(-32768, 32767, whole=True)] * 7)
VERDICT = OneOf("good", "doubtful", "refused")
SLOT = OneOf("a", "b")
IDS = ListOf(BYTE)
TERMS = ListOf(Number(0, 1 << 16, whole=True))
HZ = Number(0, 500)
WAITS = dict(pose=POSE, reason=TEXT, value=NUMBER, limit=NUMBER, unit=TEXT)
REMAINING = dict(missing=POSES, next=POSES, at=COUNT, of=COUNT)
REST = dict(still=FLAG, reason=TEXT, bias_dps=VECTOR, bias=TEXT, unseen_turn_dps=NUMBER, note=TEXT,
            verdict=OneOf("none", "good", "doubtful"), words=TEXTS, a_error_mg=NUMBER,
            noise_mg=NUMBER, temp_c=NUMBER)
KEPT = dict(slot=SLOT, sequence=COUNT, session=COUNT, measured=TEXTS, terms=TERMS)
FLIPS = Fields(taken_as=TEXT, reason=TEXT, angles_deg=MapOf(POSE, NUMBER))
GYRO = Fields("verdict", verdict=VERDICT, reason=TEXT, bias_dps=THREE, missing=TEXTS, scale=THREE,
              flips=MapOf(POSE, Fields(angle_deg=NUMBER, used=FLAG)))


class Waiting(Fields):
    """A state or a refusal: where the unit is "face" value and limit are numbers of faces."""

    def take(self, value):
        taken = super().take(value)
        if taken.get("unit") == "face":
            for name in ("value", "limit"):
                try:
                    Number(0, 5, whole=True).take(taken.get(name))
                except Misfit as misfit:
                    raise misfit.inside(name) from None
        return taken


class Mounted(Fields):
    """A mounting that is in force has all its numbers."""

    def take(self, value):
        taken = super().take(value)
        return taken if taken.get("off") else MOUNTING.take(value)


MOUNTING = Fields(
    "roll_deg pitch_deg order sigma_deg frame axes written", off=FLAG, roll_deg=NUMBER,
    pitch_deg=NUMBER, order=TEXT, sigma_deg=NUMBER, frame=TEXT, axes=TEXT, written=FLAG,
    slot=SLOT, sequence=COUNT)

EVENTS = {
    "hello": Fields(firmware=TEXT, board=TEXT, id=TEXT, sensor=TEXT, chip=TEXT, who_am_i=IDS,
                    report=TEXTS, float_bits=COUNT),
    "selftest": Fields("ok", ok=FLAG, problems=TEXTS, rate_hz=Number(0, 1e6), noise=NUMBERS,
                       still=FLAG, temperature_c=NUMBER, bus_errors=COUNT, who_am_i=IDS),
    "grace": Fields(ms=Number(0, 60000)),
    "record": Fields(verdict=VERDICT, reason=TEXT, temp_c=NUMBER, refused=MapOf(TEXT, TEXT),
                     **KEPT),
    "no_record": Fields(reason=TEXT, refused=MapOf(TEXT, TEXT)),
    "rest": Fields(**REST),
    "check": Fields("still verdict", **REST),
    "gravity": Fields("a_error_mg limit_mg", a_error_mg=NUMBER, limit_mg=NUMBER),
    "ready": Fields(corrected=FLAG, stream_hz=HZ),
    "calibrating": Fields(missing=POSES, plan=FLAG, session=COUNT, sums_only=FLAG, reason=TEXT,
                          recorded=FLAG),
    "afresh": Fields(reason=TEXT),
    "state": Waiting(state=TEXT, progress=COUNT, total=COUNT, left_s=SECONDS,
                     live=NUMBERS, **WAITS, **REMAINING),
    "pose": Fields("pose", pose=POSE, n=COUNT, mean=NUMBERS, noise=NUMBERS, **REMAINING),
    "refused": Waiting(**WAITS),
    "redo": Fields(face=POSE, **REMAINING),
    "capture": Fields(samples=COUNT, kept=COUNT, sums_only=FLAG, bytes=COUNT, reason=TEXT),
    "solved": Fields("verdict", verdict=VERDICT, reason=TEXT, missing=POSES, level=TEXT,
                     tilt_deg=NUMBER, tilt_spread_deg=NUMBER, residual_mg_rms=NUMBER,
                     residual_mg=MapOf(POSE, THREE), scale=THREE, v=THREE, noise_mg=NUMBER,
                     flips=FLIPS, gyro=GYRO),
    "saved": Fields(slot=SLOT, sequence=COUNT, written=FLAG, reason=TEXT, capture=TEXT),
    "restored": Fields(**KEPT),
    "not_restored": Fields(reason=TEXT),
    "mounted": Mounted(off=FLAG, slot=SLOT, sequence=COUNT, written=FLAG),
    "not_mounted": Fields(reason=TEXT, mounting=TEXT),
    "info": Fields(board=TEXT, id=TEXT, sensor=TEXT, slot=SLOT, sequence=COUNT, verdict=VERDICT,
                   stream_hz=HZ, raw=FLAG, heading=FLAG, binary=FLAG, bias_dps=VECTOR,
                   unfinished=FLAG, bus_errors=COUNT, free_bytes=COUNT),
    "stream": Fields("hz", hz=HZ, raw=FLAG, heading=FLAG, binary=FLAG, record=FLAG),
    "sample": Fields("t_us", t_us=COUNT, raw=RAW, a=THREE, w=THREE),
    "heading": Fields("t_us", t_us=COUNT, roll_deg=NUMBER, pitch_deg=NUMBER, yaw_deg=NUMBER),
    "term_range": Fields("temp_c low_c high_c", temp_c=NUMBER, low_c=NUMBER, high_c=NUMBER,
                         note=TEXT),
    "bus_error": Fields(errno=ERRNO, count=COUNT, action=TEXT),
    "error": Fields("what", what=TEXT, expected=TEXT),
    "reset": Fields(),
    "stopped": Fields(),
}

LEVEL = Number(0, 1, whole=True)
ADDRESS = Number(0, 127, whole=True)
POSITIVE = Number(1e-6, 1e9)
SETTINGS = MapOf(TEXT, Json(3))     # a sixflip.json: the firmware judges what is in it
# The literals that our scripts print, by what was asked.
ANSWERS = {
    "version": Row(TEXT, TEXT),
    "platform": TEXT,
    "mpy": Either(Number(0, 1 << 32, whole=True), Nothing()),
    "file": Row(TEXT, Number(0, 1 << 32, whole=True), Either(TEXT, Nothing())),
}
# Of doctor's look_at_bus.py, what follows each name.
OF_THE_BUS = {
    "settings": Row(TEXT, TEXT, TEXT, TEXTS),
    "lines": Row(TEXT, TEXT, LEVEL, LEVEL, LEVEL, LEVEL),
    "scan": Row(Either(ListOf(ADDRESS), TEXT)),
    "ids": Row(MapOf(Row(ADDRESS, BYTE), Either(Octets(), ERRNO))),
    "no sensor": Row(TEXTS),
    "sensor": Row(TEXT, TEXT, IDS, POSITIVE, POSITIVE, Number(0), TEXTS),
    "ready": Row(TEXT, COUNT, Number(0), POSITIVE, COUNT),
    "selftest": Row(FLAG, TEXTS, NUMBER, NUMBER, FLAG, Either(NUMBER, Nothing()), COUNT),
    "means": Row(COUNT, Row(*[NUMBER] * 7)),
    "lost": Row(TEXT),
    "stopped": Row(TEXT),
}


class BusAnswer:
    """One line of look_at_bus.py: a name, and what belongs to it."""

    expected = "a tuple that begins with one of " + ", ".join(OF_THE_BUS)

    def take(self, value):
        if not isinstance(value, tuple) or not value or not isinstance(value[0], str) \
                or value[0] not in OF_THE_BUS:
            raise Misfit(value, self.expected)
        return (value[0], *OF_THE_BUS[value[0]].take(value[1:]))


def event(told):
    """The checked event of a dict with an "event", None of one that nobody knows.

    Where a value does not fit: {"event": "misfit", "of": the event, "why": what was expected}.
    """
    name = told["event"]
    if name not in EVENTS:
        return None
    try:
        return dict({"event": name}, **EVENTS[name].take(told))
    except Misfit as misfit:
        return {"event": "misfit", "of": name, "why": "%s: %s" % (name, misfit)}

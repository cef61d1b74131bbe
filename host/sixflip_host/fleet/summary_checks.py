"""Whether what a summary's file holds is one: every array of its shape, finite and in range.

A summary may come from anywhere; what passes here is solved and diagnosed like any other.
"""
import numpy as np

from sixflip.poses.faces import LEANING, MOST_LEANING

from ..capture.capture_header import check_meta
from ..experiment.way_memory import FRICTION, TURNED_S
from ..value_kinds import (
    LARGEST,
    Either,
    Fields,
    Flag,
    Json,
    ListOf,
    MapOf,
    Nothing,
    Number,
    OneOf,
    Row,
    Text,
)

MOST_POSES, MOST_BLOCKS, MOST_SECONDS = 1000, 10_000, 200_000
MOST_COUNTS = 1 << 52  # of a sum: whole as a float, too
REAL = Number()
SENSOR = OneOf("accel", "gyro", "device")
FINDING = Fields("sensor effect axes domain score_nats words value unit plausible number place",
                 sensor=SENSOR, effect=Text(), axes=ListOf(OneOf(*"xyz")), domain=Text(),
                 score_nats=Number(-1e12, 1e12), words=Text(), value=MapOf(Text(), REAL),
                 unit=Text(), plausible=Flag(), share=Either(Number(0.0, 1.0), Nothing()),
                 number=Number(0.0, 1e12), place=MapOf(Text(), Number(0.0, 1.0)))
PLACE = Fields("sensor domain p", sensor=SENSOR, axis=Either(OneOf(*"xyz"), Nothing()),
               domain=Text(), p=Number(0.0, 1.0))
ABOUT = Fields(
    "format name labelled found_labelled gyro meta remarks bounds flips samples",
    format=Number(0, 1000, whole=True), name=Text(), labelled=Flag(), found_labelled=Flag(),
    gyro=Flag(), meta=MapOf(Text(), Json(3)), remarks=ListOf(Text()),
    bounds=Row(REAL, Number(0.0, LARGEST)), hash=Text(), stamp=Row(REAL, Number(0, 1e20)),
    flips=Fields("reason angles measured", reason=Text(),
                 angles=ListOf(Row(Number(0, 5, whole=True), REAL)),
                 measured=ListOf(Row(Number(0, 5, whole=True), REAL, Number(0.0)))),
    samples=Fields("findings nameless scaled remarks", findings=ListOf(FINDING),
                   nameless=ListOf(PLACE), scaled=Flag(), remarks=ListOf(Text())))


def about(value):
    """The JSON of a summary, once checked; ValueError otherwise."""
    checked = ABOUT.take(value)
    meta = checked["meta"]
    columns = ["ax"] + (["gx"] if checked["gyro"] else [])

    def fault(seen, expected):
        return ValueError("%s, expected %s" % (seen, expected))
    try:
        check_meta(meta, columns, fault)
    except TypeError:
        raise ValueError("a key of its capture is of another kind") from None
    if not 0.01 <= meta["rate_hz"] <= 1e6:
        raise ValueError("rate_hz is %g" % meta["rate_hz"])
    return checked


def arrays(tables, columns):
    """ValueError unless the arrays are those of a summary; columns: {name: number} of the tables
    that a summary has."""
    for name, table in tables.items():
        if table.dtype.kind not in "if" or table.size > MOST_BLOCKS * 20 + MOST_SECONDS \
                or not np.isfinite(table).all() or np.abs(table).max(initial=0) > MOST_COUNTS:
            raise ValueError(name)
    for name, number in columns.items():
        if tables[name].ndim != 2 or tables[name].shape[1] != number:
            raise ValueError(name)
    _placements(tables)
    _blocks(tables)


def _need(holds, name):
    if not holds:
        raise ValueError(name)


def _codes(codes):
    return bool(((codes >= 1) & (codes <= LEANING + MOST_LEANING)).all())


def _placements(tables):
    """Those of the tables that solve needs."""
    of, number = tables["placement_of"], len(tables["placement_of"])
    _need(number <= MOST_POSES and of.dtype.kind == "i" and _codes(of[:, 0])
          and (of[:, 1] >= 0).all() and (of[:, 2] > 0).all() and (of[:, 3] >= 0).all(),
          "placement_of")
    sums = tables["placement_sums"]
    _need(len(sums) == number and sums.dtype.kind == "i"
          and (np.abs(sums) <= of[:, 2:3] * 32768).all(), "placement_sums")
    noise = tables["placement_noise"]
    _need(len(noise) == number and (noise >= 0.0).all() and (noise < 1e5).all(),
          "placement_noise")
    _need(len(tables["halves"]) == number, "halves")
    moves = tables["move_of"]
    _need(len(moves) in (0, max(0, number - 1)) and moves.dtype.kind == "i", "move_of")
    if len(moves):
        _need((moves[:, :2] >= -1).all() and (moves[:, :2] < number).all()
              and (moves[:, 2] >= 0).all() and (moves[:, 3] >= 0).all()
              and (moves[:, 7] >= 0).all() and (moves[:, 13] >= 0).all(), "move_of")


def _blocks(tables):
    """Those of the blocks of the rests."""
    runs, n = tables["runs"], len(tables["block_placement"])
    _need(len(runs) <= MOST_POSES and runs.dtype.kind == "i" and _codes(runs[:, 0]), "runs")
    _need(tables["starts"].shape == (len(runs),), "starts")
    _need(n <= MOST_BLOCKS and tables["friction"].shape == (n, len(FRICTION), 3),
          "friction")
    _need(("turned" in tables) == ("block_gyro" in tables), "turned")
    _need("turned" not in tables or tables["turned"].shape == (n, len(TURNED_S), 3), "turned")
    place = tables["block_placement"]
    _need(place.shape == (n,) and place.dtype.kind == "i" and (np.diff(place) >= 0).all()
          and (not n or 0 <= place[0] and place[-1] < len(runs)), "block_placement")
    for name in ("code", "first", "end", "face"):
        column = tables["block_" + name]
        _need(column.shape == (n,) and column.dtype.kind == "i", name)
    _need(_codes(tables["block_code"]) and (np.abs(tables["block_face"]) <= 5).all(), "block_code")
    for name in ("t", "since", "seconds", "loudness", "temperature", "temperature_rate"):
        column = tables.get("block_" + name)
        _need(column is None and name.startswith("temperature") or column is not None
              and column.shape == (n,) and (np.abs(column) < LARGEST).all(), name)
    _need((np.diff(tables["block_t"]) > 0.0).all() and (tables["block_seconds"] > 0.0).all(), "t")
    for sensor in ("accel", "gyro"):
        own = [tables.get(name % sensor) for name in ("block_%s", "block_noise_%s",
                                                      "block_rounding_%s")]
        there = [one is not None for one in own]
        _need(all(there) or not any(there) and (sensor == "gyro" or not n) or not n, sensor)
        if all(there):
            _need(own[0].shape == (n, 3) and (np.abs(own[0]) < LARGEST).all(), sensor)
            _need(own[1].shape == own[2].shape == (3,) and (own[1] > 0.0).all()
                  and (own[2] >= 0.0).all(), "noise_" + sensor)
    smooth = tables.get("thermometer")
    _need((smooth is None) == (tables.get("block_temperature") is None), "thermometer")
    if smooth is not None:
        _need(smooth.ndim == 1 and 4 <= len(smooth) <= MOST_SECONDS
              and (np.abs(smooth) < LARGEST).all(), "thermometer")

"""What kind of file something is, told by its content: what an output may replace."""

import zlib

from .errors import BadFile

HEAD = 1 << 14          # bytes that are looked at
GZIP = b"\x1f\x8b"

RECORD = "a correction record"
BOARD_CAPTURE = "a board's capture"
CAPTURE = "a capture"
SIMULATED = "a simulated capture"
SAMPLES = "streamed samples"
CORRECTED = "corrected samples"
PARQUET = "Parquet"
NPZ = "NPZ of a capture"
MCAP = "MCAP"
PNG = "a PNG picture"
PAGE = "a page of Sixflip"
JUNIT = "JUnit XML of Sixflip"
SCENARIO = "a scenario of diagnose"
PLAN = "a plan"
WORLDS = "simulated worlds"
RECORD_JSON = "a record as JSON"
IMU_CALIB = "a correction for imu_calib"
IMUFUSION = "a correction for imufusion"
IMUCAL = "a correction for imucal"
C_HEADER = "a correction as C header"
SDF = "a sensor in SDF"
KALIBR = "an imu.yaml of Kalibr"
TABLE = "a table of noise and bias"
DIAGNOSIS = "a diagnosis as JSON"
RANDOMISATION = "a randomisation of sixflip fleet"
FLEET = "a population of sixflip fleet"
PUT_BACK = "a simulator's settings"
JSON = "a JSON object"
FLASH = "an image of a flash"

# kind: bytes that a file of it begins with, bytes that stand somewhere in its head; the first fits
SIGNS = (
    (RECORD, b"6FLP", b""),
    (BOARD_CAPTURE, b"6CAP", b""),
    (SIMULATED, b"# sixflip-capture", b'"simulated": {'),
    (CAPTURE, b"# sixflip-capture", b""),
    (CORRECTED, b"t_us,ax_mps2", b""),
    (SAMPLES, b"t_us,", b""),
    (PARQUET, b"PAR1", b""),
    (NPZ, b"PK", b"about.npy"),
    (MCAP, b"\x89MCAP", b""),
    (PNG, b"\x89PNG", b""),
    (PAGE, b"<!doctype html><html lang=en><meta charset=utf-8><meta http-equiv", b""),
    (JUNIT, b"<?xml", b'<testsuite name="sixflip'),
    (RANDOMISATION, b'"""', b"sixflip fleet --randomise"),
    (PUT_BACK, b"", b"put back by sixflip export"),
    (SDF, b"<?xml", b"stddev = N sqrt(rate)"),
    (SCENARIO, b"#", b"`sixflip diagnose` found"),
    (IMU_CALIB, b"#", b"formula of imu_calib"),
    (IMUFUSION, b"#", b"formula of imufusion"),
    (KALIBR, b"#", b"Densities in continuous time"),
    (TABLE, b"#", b"measured = M true + bias"),
    (C_HEADER, b"/*", b"SIXFLIP_CORRECTION_H"),
    (IMUCAL, b"{", b"formula of imucal"),
    (RECORD_JSON, b"{", b'"kind": "sixflip correction record"'),
    (PLAN, b"{", b'"sixflip_plan"'),
    (FLEET, b"{", b'"kind": "sixflip fleet"'),
    (DIAGNOSIS, b"{", b'"causes": '),
    (JSON, b"{", b""),
    (WORLDS, b"[", b'"sensor"'),
    (FLASH, b"", b"littlefs"),
)


def head_of(path):
    """The first bytes of a file's content, unpacked; None where it is no gzip but begins so."""
    try:
        with open(path, "rb") as file:
            head = file.read(HEAD)
    except OSError as error:
        raise BadFile("%s: cannot be read: %s" % (path, error.strerror)) from None
    if head.startswith(GZIP):
        try:
            head = zlib.decompressobj(wbits=31).decompress(head, HEAD)
        except zlib.error:
            return None
    return head


def kind_of(path):
    """One of the kinds above; None for any other file, "" for one without content."""
    head = head_of(path)
    if head is None:
        return None
    if not head.strip(b"\xff\0 \r\n"):      # an erased flash is one, too
        return ""
    for kind, start, somewhere in SIGNS:
        if head.startswith(start) and somewhere in head:
            return kind
    return None

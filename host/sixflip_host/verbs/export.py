"""sixflip export: a capture or a record in another format.

The record in the conventions of imu_calib, imufusion and imucal takes the place of the
paper's do_calib: its apply_calib node, or an attitude filter, then corrects what raw_imu says.
"""

import json

from .. import atomic_write, file_kinds
from ..calibrate.record_json import record_json
from ..calibrate.verify_files import read_record
from ..capture import capture_binary, capture_file
from ..errors import UsageError
from ..export import (
    export_c,
    export_formats,
    export_mcap,
    export_tables,
    other_simulators,
    put_back,
    put_back_native,
    put_back_numpy,
)
from ..file_arguments import add_input, add_output

EXAMPLE = ("sixflip export record_a.bin --format imu_calib -o imu_calib.yaml\n"
           "         sixflip export record_a.bin -o sixflip_correction.h")


def capture_csv(path, output):
    """Text capture; gzipped when the name ends in .gz."""
    capture_file.write(output, capture_file.read_samples(path))


def capture_bin(path, output):
    """A board's file."""
    atomic_write.write_bytes(output, capture_binary.encode(capture_file.read_samples(path)))


def capture_data(write):
    """A capture's raw counts for other tools; write: function(output, capture)."""
    def convert(path, output):
        write(output, capture_file.read_samples(path))
    return convert


def record_to_json(path, output):
    """Everything in a record, units in the names."""
    answer = record_json(read_record(path))
    atomic_write.write_text(output, json.dumps(answer, indent=1) + "\n")


def record_text(make):
    """A record as somebody else's file; make: a function of export_formats."""
    def write(path, output):
        atomic_write.write_text(output, make(path, read_record(path)))
    return write


def frozen_text(make):
    """A record as somebody else's file that knows no temperature: it holds at one."""
    def write(path, output, temp_c=None):
        atomic_write.write_text(output, make(path, read_record(path), temp_c))
    return write


def settings(make):
    """What a diagnosis found, for a simulator; make: function of a PutBack."""
    def write(path, output):
        atomic_write.write_text(output, make(put_back.read(path)))
    return write


# format: (made from, how, endings of a file name that ask for it, kinds of file it is)
FORMATS = {
    "csv": ("capture", capture_csv, (".csv", ".csv.gz"),
            (file_kinds.CAPTURE, file_kinds.SIMULATED)),
    "bin": ("capture", capture_bin, (".bin",), (file_kinds.BOARD_CAPTURE,)),
    "json": ("record", record_to_json, (".json",), (file_kinds.RECORD_JSON,)),
    "imu_calib": ("record", frozen_text(export_formats.imu_calib_yaml), (".yaml", ".yml"),
                  (file_kinds.IMU_CALIB,)),
    "imufusion": ("record", frozen_text(export_formats.imufusion_python), (".py",),
                  (file_kinds.IMUFUSION,)),
    "imucal": ("record", frozen_text(export_formats.imucal_json), (), (file_kinds.IMUCAL,)),
    "c-header": ("record", record_text(export_c.c_header), (".h",), (file_kinds.C_HEADER,)),
    "parquet": ("capture", capture_data(export_tables.parquet), (".parquet",),
                (file_kinds.PARQUET,)),
    "npz": ("capture", capture_data(export_tables.npz), (".npz",), (file_kinds.NPZ,)),
    "mcap": ("capture", capture_data(export_mcap.mcap), (".mcap",), (file_kinds.MCAP,)),
    "sdf": ("capture", other_simulators.capture_sdf, (".sdf",), (file_kinds.SDF,)),
    "kalibr": ("capture", other_simulators.capture_kalibr, (".yaml", ".yml"),
               (file_kinds.KALIBR,)),
    "table": ("capture", other_simulators.capture_table, (".txt",), (file_kinds.TABLE,)),
}
# the same of a diagnosis made with --sim: what the real sensor has beyond the simulator
PUT_BACK = {"numpy": put_back_numpy.text, "gz": put_back_native.gz,
            "mujoco": put_back_native.mujoco, "genesis": put_back_native.genesis,
            "isaaclab": put_back_native.isaaclab, "matlab": put_back_native.matlab,
            "kalibr": put_back_native.kalibr}
FROZEN = ("imu_calib", "imufusion", "imucal")


def add_arguments(parser):
    """The options of the verb."""
    add_input(parser, "file", help="capture, record or the JSON of diagnose --sim")
    add_output(parser, "-o", "--output", required=True, kinds=_kinds, help="file to write")
    parser.add_argument("--format", "--to", dest="to",
                        choices=[*FORMATS, *(n for n in PUT_BACK if n not in FORMATS)],
                        help="default: by the name of the output")
    parser.add_argument("--temperature", type=float, metavar="DEGC", help="at which a record that "
                        "follows it is frozen, in formats that know none (default: the "
                        "calibration's)")


def _asked(args):
    """The formats that are asked for: by --format, or by the name of the output."""
    return [args.to] if args.to else _by_name(args.output)


def _kinds(args):
    return [kind for name in _asked(args)
            for kind in (FORMATS[name][3] if name in FORMATS else ()) + (
                (file_kinds.PUT_BACK,) if name in PUT_BACK else ())]


def run(args):
    """Convert one file."""
    asked = _asked(args)
    if file_kinds.kind_of(args.file) == file_kinds.DIAGNOSIS or asked[0] not in FORMATS:
        return of_diagnosis(args, asked)
    kind = "record" if file_kinds.kind_of(args.file) == file_kinds.RECORD else "capture"
    # where two formats have the same ending, the one that is made from such a file
    name = next((one for one in asked if FORMATS[one][0] == kind), asked[0])
    made_from, how, *_ = FORMATS[name]
    if kind != made_from:
        raise UsageError("%s is a %s, and %s is made from a %s: expected --format %s" % (
            args.file, kind, name, made_from, " or ".join(
                one for one in FORMATS if FORMATS[one][0] == kind)))
    if name in FROZEN:
        how(args.file, args.output, args.temperature)
    elif args.temperature is None:
        how(args.file, args.output)
    else:
        raise UsageError("--temperature: expected --format %s with it" % " or ".join(FROZEN))
    return 0


def of_diagnosis(args, asked):
    """Settings or code for a simulator."""
    if not args.to or args.to not in PUT_BACK:
        raise UsageError("%s: expected --to %s with a diagnosis" % (
            args.file, " or ".join(PUT_BACK)))
    if args.temperature is not None:
        raise UsageError("--temperature: expected --format %s with it" % " or ".join(FROZEN))
    settings(PUT_BACK[asked[0]])(args.file, args.output)
    return 0


def _by_name(output):
    """The formats an ending asks for."""
    asked = [name for name, (_, _, endings, _) in FORMATS.items()
             if endings and output.endswith(endings)]
    if not asked:
        raise UsageError("%s: its name does not say the format, expected --format %s" % (
            output, " or ".join(FORMATS)))
    return asked

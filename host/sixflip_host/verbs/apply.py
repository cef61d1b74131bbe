"""sixflip apply: corrected samples in SI units from raw counts and a record."""
import sys

from .. import atomic_write, file_kinds
from ..calibrate.verify_files import read_record
from ..capture import capture_file
from ..errors import BadFile
from ..export.corrected_rows import corrected
from ..file_arguments import add_input, add_output

EXAMPLE = ("sixflip apply record_a.bin capture.csv -o corrected.csv\n"
           "         sixflip apply record_a.bin capture.csv -o corrected.mcap")


def add_arguments(parser):
    """The options of the verb."""
    add_input(parser, "record", help="correction record")
    add_input(parser, "capture", help="capture with the raw counts")
    add_output(parser, "-o", "--output", required=True, kinds=lambda args: _form(args.output)[1:],
               help="file to write: .parquet, .npz or .mcap, else CSV")
    parser.add_argument("--other-sensor", action="store_true",
                        help="even if it is another chip or range")


def run(args):
    """Correct every sample."""
    record = read_record(args.record)
    capture = capture_file.read_samples(args.capture)
    if not args.other_sensor:
        _fits(args, record, capture)
    outside = []
    _form(args.output)[0](args.output, capture, record,
                          lambda *celsius: outside.append(celsius))
    for _, low, high in outside:
        print("the temperature leaves %.1f to %.1f °C, what the record's terms were measured "
              "at: beyond it their edge holds" % (low, high), file=sys.stderr)
    return 0


def _form(output):
    """By the ending of a name: function(output, capture, record, tell), kind of file."""
    from ..export import export_mcap, export_tables
    for ending, write, kind in ((".parquet", export_tables.parquet, file_kinds.PARQUET),
                                (".npz", export_tables.npz, file_kinds.NPZ),
                                (".mcap", export_mcap.mcap, file_kinds.MCAP)):
        if output.endswith(ending):
            return write, kind
    return _csv, file_kinds.CORRECTED


def _csv(output, capture, record, tell):
    columns, names = corrected(record, capture, tell)
    lines = ["%d,%s\n" % (t, ",".join(["%.7g" % x for x in row]))
             for t, row in zip(capture.t_us.tolist(), columns.tolist())]
    atomic_write.write_text(output, ",".join(["t_us", *names]) + "\n" + "".join(lines))




def _fits(args, record, capture):
    """A record of another chip or range would correct nothing."""
    pairs = [("sensor", record.chip, capture.meta["sensor"], False),
             ("counts per g", record.accel_lsb_per_g, capture.meta["accel_lsb_per_g"], True)]
    if capture.gyro is not None and record.gyro_lsb_per_dps:
        pairs.append(("counts per deg/s", record.gyro_lsb_per_dps,
                      capture.meta["gyro_lsb_per_dps"], True))
    for what, has, wants, number in pairs:
        if (abs(has - wants) > 5.1e-4 if number else has != wants):
            raise BadFile("%s is for %s %s, %s has %s: expected a record of this sensor "
                          "(or --other-sensor)" % (args.record, what, has, args.capture, wants))

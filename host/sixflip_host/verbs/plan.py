"""sixflip plan: what a capture would be able to tell apart, before anything is captured."""
import json
import sys

from sixflip.chips import catalogue

from .. import file_kinds, progress
from ..board import board_settings
from ..did_you_mean import instead
from ..errors import UsageError
from ..file_arguments import add_input, add_output
from ..fleet import fleet_prior
from ..planning import plan_file, protocols
from ..terminal import plain

EXAMPLE = "sixflip plan --protocol recommended --sensor mpu6050 --save session.json"
SENSORS = (*catalogue.SENSORS, "itg3205")
MOST_PLACEMENTS = 120  # dense algebra: the time grows with the cube


def add_arguments(parser):
    add_input(parser, "--protocol", default="recommended", metavar="NAME|FILE",
              help="%s, or a plan file (default: recommended)" % ", ".join(protocols.STILL))
    parser.add_argument("--sensor", default="mpu6050", choices=SENSORS,
                        help="whose typical sizes and noise to judge by (default: mpu6050)")
    parser.add_argument("--certified-box", action="store_true",
                        help="the box is known to be square (its faces are no unknowns)")
    parser.add_argument("--rate", type=float, default=100.0, metavar="HZ",
                        help="samples a second (default: 100)")
    parser.add_argument("--range", metavar="8g,2000dps",
                        help="full scales of accelerometer and gyro, one or both (default: the "
                             "chip's usual ones, 2 g and 500 deg/s where it has them)")
    add_input(parser, "--prior", metavar="FLEET.json",
              help="how large effects are in boards of this kind, from sixflip fleet, instead of "
                   "the sizes of data sheets")
    parser.add_argument("--minutes", type=float, metavar="N",
                        help="propose only what keeps the whole capture within N minutes")
    parser.add_argument("--json", action="store_true", help="the answer as JSON")
    add_output(parser, "--plot", metavar="PNG", kinds=(file_kinds.PNG,),
               help="draw the alias matrix")
    add_output(parser, "--save", metavar="FILE", kinds=(file_kinds.PLAN,),
               help="write the protocol as a plan file")


def run(args):
    from ..planning import plan_answer
    if not 1.0 <= args.rate <= 10000.0:
        raise UsageError("--rate is %g, expected 1 to 10000 Hz" % args.rate)
    if args.minutes is not None and not 0.0 < args.minutes <= 10000.0:
        raise UsageError("--minutes is %g, expected more than 0" % args.minutes)
    wanted = board_settings.ranges(args.range) if args.range else {}
    wanted, notes = board_settings.what_the_chip_offers(args.sensor, wanted)
    for note in notes:
        print("sixflip plan: " + plain(note), file=sys.stderr)
    protocol = protocol_of(args.protocol)
    placements = sum(len(s.rests) for s in protocol.sessions)
    if placements > MOST_PLACEMENTS:
        raise UsageError("the protocol has %d placements, expected at most %d"
                         % (placements, MOST_PLACEMENTS))
    with progress.during("plan"):
        answer, findings = plan_answer.planned(protocol, args.sensor, args.certified_box,
                                               args.rate, args.minutes,
                                               (wanted.get("accel_range_g"),
                                                wanted.get("gyro_range_dps")),
                                               fleet_prior.read(args.prior, args.sensor)
                                               if args.prior else None)
    if args.plot:
        from ..present.gap_pictures import draw_alias
        draw_alias(findings.matrices, args.plot, protocol.name)
    if args.save:
        plan_file.write(args.save, protocol)
    if args.json:
        print(json.dumps(answer, indent=1, allow_nan=False))
    else:
        from ..present.plan_words import show
        show(answer)
    return 0


def protocol_of(name):
    """A named protocol, or the one in a plan file; UsageError when it is neither."""
    if name in protocols.STILL:
        return protocols.named(name)
    if name in protocols.NAMES:
        raise UsageError("%s is a scene to simulate, not a capture of still poses; expected "
                         "one of %s, or a plan file" % (name, ", ".join(protocols.STILL)))
    if not any(c in name for c in "./\\"):
        raise UsageError("no protocol named %r, %s, or a plan file"
                         % (name, instead(name, protocols.STILL)))
    return plan_file.read(name)







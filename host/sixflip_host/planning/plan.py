"""sixflip plan: what a capture would be able to tell apart, before anything is captured."""
import json
import math

from .. import file_kinds, progress
from ..did_you_mean import instead
from ..errors import UsageError
from ..file_arguments import add_input, add_output
from ..simulating import protocols
from ..simulating.session_rows import rows_of
from . import alias, plan_additions, plan_file
from .plan_findings import Findings

HELP = "say what a capture can tell apart, what it cannot, and what to add; no capture needed"
EXAMPLE = "sixflip plan --protocol recommended --sensor mpu6050 --save session.json"
SENSORS = ("mpu6050", "gy85", "adxl345", "itg3205")
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
    parser.add_argument("--minutes", type=float, metavar="N",
                        help="propose only what keeps the whole capture within N minutes")
    parser.add_argument("--json", action="store_true", help="the answer as JSON")
    add_output(parser, "--plot", metavar="PNG", kinds=(file_kinds.PNG,),
               help="draw the alias matrix")
    add_output(parser, "--save", metavar="FILE", kinds=(file_kinds.PLAN,),
               help="write the protocol as a plan file")


def run(args):
    if not 1.0 <= args.rate <= 10000.0:
        raise UsageError("--rate is %g, expected 1 to 10000 Hz" % args.rate)
    if args.minutes is not None and not 0.0 < args.minutes <= 10000.0:
        raise UsageError("--minutes is %g, expected more than 0" % args.minutes)
    protocol = protocol_of(args.protocol)
    placements = sum(len(s.rests) for s in protocol.sessions)
    if placements > MOST_PLACEMENTS:
        raise UsageError("the protocol has %d placements, expected at most %d"
                         % (placements, MOST_PLACEMENTS))
    with progress.during("plan"):
        progress.doing("what the capture shows")
        findings = Findings(protocol, args.sensor, args.certified_box, args.rate)
        progress.doing("what could be added")
        additions = plan_additions.ranked(protocol, findings, args.sensor, args.certified_box,
                                          args.rate, args.minutes)
    answer = as_dict(protocol, args, findings, additions)
    if args.plot:
        from .alias_picture import draw
        draw(findings.matrices, args.plot, protocol.name)
    if args.save:
        plan_file.write(args.save, protocol)
    if args.json:
        print(json.dumps(answer, indent=1, allow_nan=False))
    else:
        from .plan_words import show
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


def counts(protocol):
    """Equations, residual degrees of freedom and even contrasts for the accelerometer, one
    mean a placement: what is there to see, before any effect is named."""
    rows = rows_of(protocol)
    design = alias.Design(rows, "accel", certified_box=True, tilt=False)
    return {"equations": 3 * rows.n, "residual": design.freedom,
            "even_contrasts": alias.even_contrasts(rows)}


def as_dict(protocol, args, findings, additions):
    """The answer of --json; null for a size that no sample could show."""
    effects = []
    for f in findings.list:
        effects.append({
            "effect": f.effect, "sensor": f.sensor, "unit": f.unit, "silent": f.silent,
            "absorbed_by": f.absorbed or None,
            "smallest": None if math.isinf(f.smallest) else rounded(f.smallest),
            "typical": f.typical, "source": f.source, "seen_at_typical_size": f.seen,
            "class": {name: round(index, 2) for name, index in sorted(f.members.items())},
            "how": f.how or None})
    return {
        "format": 1, "protocol": protocol.name, "sensor": args.sensor,
        "certified_box": args.certified_box, "minutes": round(protocol.minutes, 2),
        "placements": sum(len(s.rests) for s in protocol.sessions),
        "sessions": [s.state for s in protocol.sessions], "accel": counts(protocol),
        "effects": effects,
        "alias": {kind: {"names": names, "index": [[round(float(v), 3) for v in row]
                                                   for row in index]}
                  for kind, (names, index) in findings.matrices.items()},
        "additions": [{
            "add": a.name, "minutes": round(a.minutes, 2), "per_minute": round(a.per_minute, 2),
            "tells_apart": [list(p) for p in a.pairs], "no_longer_silent": [list(s)
                                                                             for s in a.shown],
            "typical_size_reached": [list(r) for r in a.reached]} for a in additions]}


def rounded(value):
    """Three significant digits: more would claim what the formula does not know."""
    return float("%.3g" % value)

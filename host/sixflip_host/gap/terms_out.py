"""The terms found: into a record, as JSON, and in words."""
from sixflip import correction_record

from .. import atomic_write
from ..capture import term_words
from ..errors import CheckFailed
from ..mounting import mount
from ..terminal import plain
from .correction_terms import Terms, fitting


def found(diagnosis, record, args):
    """Terms of a Diagnosis for a record; CheckFailed or BadFile when it is another sensor's."""
    for session in diagnosis.sessions:
        mount.fits(record, session.capture)
    fitting(diagnosis, record, args.record)
    return Terms(diagnosis, record)


def answer(terms, output):
    """dict for the JSON answer."""
    return {"written": output if terms.found else None,
            "found": [dict(term_words.facts(t.name, t.fields), term=t.name) for t in terms.found],
            "left_out": [{"sensor": sensor, "effects": names, "reason": reason}
                         for sensor, names, reason in terms.left_out]}


def show(out, result):
    """Print what an answer() holds."""
    for term in result["found"]:
        for line in term_words.lines(term):
            out.print(plain("Into the record: " + line))
    for one in result["left_out"]:
        out.print(plain("Not into the record: %s (%s): %s" % (
            " or ".join(one["effects"]), one["sensor"], one["reason"])))
    if result["written"]:
        out.print(plain("%s: sixflip restore --from it puts it onto the board"
                        % result["written"]))


def write(terms, args):
    """The record with the terms; CheckFailed when there are none."""
    if not terms.found:
        raise CheckFailed("nothing was found that a record can take out: %s is not written"
                          % args.output)
    atomic_write.write_bytes(args.output, correction_record.encode(terms.record))

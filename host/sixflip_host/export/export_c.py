"""A correction as a C header: single precision, no heap, C99 and C++ (Arduino, ESP-IDF)."""

from sixflip.record.correction import correction_of

from ..record_terms import TERMS
from . import export_c_text as text
from .affine_correction import AffineCorrection


def c_header(path, record):
    """Text of the header, with the terms the record has. Raises BadFile for a record without
    an accelerometer's correction."""
    affine = AffineCorrection(path, record)
    correction = correction_of(record)
    parts = [_head(affine), _defines(record), _table("sixflip_accel_table", correction.accel)]
    if not affine.gyro:      # neither has it a thermometer
        return "\n".join([*parts, text.ACCEL]) + text.TAIL
    parts.append(_table("sixflip_gyro_table", correction.gyro))
    parts += [*_terms(correction), text.GYRO_OFFSET, text.REST_TERMS] if record.terms else \
        [text.PLAIN, text.GYRO_OFFSET, text.REST_PLAIN]
    return "\n".join([*parts, text.CORRECT]) + text.TAIL


def _terms(correction):
    """Tables of a TermCorrection and the function that applies them, in the order it does."""
    tables, calls = [], []
    for number, term in enumerate(correction.thermal):
        name = "sixflip_thermal_%d" % number
        tables += [_table(name, [term.base, term.k1, term.k2]),
                   _row(name + "_range", [term.t0, term.low, term.high, term.lsb, term.offset])]
        into = "scale" if term.into is correction.scale else "shift"
        calls.append("    sixflip_thermal(%s, %s_range, temp, %s + %d);\n" % (
            name, name, into, term.first))
    tables.append(_table("sixflip_coupling", correction.coupling or [[0.0] * 3] * 3))
    tables.append(_table("sixflip_turn", correction.turn or [
        [1.0 if i == j else 0.0 for j in range(3)] for i in range(3)]))
    tables += [text.THERMAL] if calls else []
    return [*tables, text.TERMS.replace("CALLS", "".join(calls))]


def _head(affine):
    names = [name for tag, name in TERMS if tag in [one for one, _ in affine.record.terms]]
    lines = [_comment(line) for line in affine.origin()] + ["", text.FORMULA]
    lines += [text.TERM_FORMULA % " ".join(names)] if names else []
    lines += ["", text.USE_GYRO if affine.gyro else text.USE]
    return "/*\n%s\n*/\n#ifndef SIXFLIP_CORRECTION_H\n#define SIXFLIP_CORRECTION_H\n\n" \
        "#include <stdint.h>\n\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n" \
        % "\n".join(lines)


def _comment(line):
    """What a record says of itself, unable to end the comment or to mean anything in it."""
    line = "".join(c if " " <= c <= "~" else "?" for c in line)
    for pair in ("*/", "/*", "??"):
        while pair in line:
            line = line.replace(pair, pair[0] + " " + pair[1])
    return line.replace("\\", "/")


def _defines(record):
    lines = ["#define SIXFLIP_ACCEL_RANGE_G %d" % record.accel_range_g,
             "#define SIXFLIP_ACCEL_LSB_PER_G %s" % _float(record.accel_lsb_per_g),
             "#define SIXFLIP_GRAVITY %s /* m/s^2, of the calibration */" % _float(record.g),
             "#define SIXFLIP_HAS_GYRO %d" % bool(record.gyro_lsb_per_dps)]
    if record.gyro_lsb_per_dps:
        lines += ["#define SIXFLIP_GYRO_RANGE_DPS %d" % record.gyro_range_dps,
                  "#define SIXFLIP_GYRO_LSB_PER_DPS %s" % _float(record.gyro_lsb_per_dps)]
    return "\n".join(lines) + "\n"


def _float(value):
    """A literal of single precision."""
    text = "%.9g" % value
    return text + ("f" if any(c in text for c in ".e") else ".0f")


def _row(name, values):
    return "static const float %s[%d] = {%s};\n" % (
        name, len(values), ", ".join(_float(x) for x in values))


def _table(name, M):
    rows = ",\n".join("    {%s}" % ", ".join(_float(x) for x in row) for row in M)
    return "static const float %s[%d][3] = {\n%s\n};\n" % (name, len(M), rows)

"""Whether stated probabilities are true: causes that were there, by what was stated of them and by
what was named."""

from collections import defaultdict

from .statsmath import wilson

EDGES = (0.0, 0.5, 0.8, 0.9, 0.95, 0.99, 1.0)


def table(head, rows):
    cells = [head] + [tuple(str(c) for c in row) for row in rows]
    widths = [max(len(row[k]) for row in cells) for k in range(len(head))]
    lines = ["  ".join(c.ljust(w) for c, w in zip(row, widths)).rstrip() for row in cells]
    lines.insert(1, "-" * len(lines[0]))
    return "\n".join(lines)


def bins(results):
    """[(low, high, mean stated probability, n, right)] of causes by stated probability."""
    flat = [(c[3], [c[0], c[1]] not in r["false"]) for r in results for c in r["named"]
            if c[3] is not None]
    out = []
    for low, high in zip(EDGES[:-1], EDGES[1:]):
        here = [one for one in flat if low <= one[0] < high or one[0] == high == 1.0]
        stated = sum(p for p, _ in here) / len(here) if here else None
        out.append((low, high, stated, len(here), sum(right for _, right in here)))
    return out


def calibration_error(results):
    """(expected calibration error, number of causes): how far the share of causes that were
    there is off the mean probability stated, averaged over the causes [Naeini, Cooper &
    Hauskrecht, AAAI 2015]."""
    filled = [b for b in bins(results) if b[3]]
    number = sum(n for *_, n, _ in filled)
    off = sum(abs(n * stated - right) for _, _, stated, n, right in filled)
    return off / max(number, 1), number


def table_of(results):
    rows = []
    for low, high, stated, n, right in bins(results):
        interval = "%.0f-%.0f" % tuple(100 * x for x in wilson(right, n)) if n else ""
        rows.append(("%g-%g" % (low, high), n, "%.3f" % stated if n else "-",
                     "%.3f" % (right / n) if n else "-", interval))
    return "Reliability: causes that were there, by stated probability\n\n" + table(
        ("stated", "causes", "mean", "were there", "95 % interval, %"), rows)


def by_name(results):
    """[(name or class, causes, mean stated probability, right)], the furthest off the mark, in
    causes, first: which names are stated too surely, or not surely enough."""
    groups = defaultdict(list)
    for r in results:
        for sensor, name, _, stated in r["named"]:
            if stated is not None:
                groups[name].append((stated, [sensor, name] not in r["false"]))
    rows = [(name, len(here), sum(p for p, _ in here) / len(here), sum(ok for _, ok in here))
            for name, here in groups.items()]
    return sorted(rows, key=lambda row: (-abs(row[1] * row[2] - row[3]), row[0]))


def by_name_table(results):
    rows = [(name, n, "%.3f" % stated, "%.3f" % (right / n))
            for name, n, stated, right in by_name(results)]
    return "Reliability by what was named\n\n" + table(
        ("named", "causes", "mean stated", "were there"), rows) if rows else ""

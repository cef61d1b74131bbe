"""What a malicious or broken board makes of an honest one's words, by seed: wrong types, missing,
extra, repeated, reordered, huge, nested, damaged, dripping and endless answers."""

import ast
import base64
import itertools
import json
import random
import re

VALUES = (None, True, False, -1, 0, 1, 7, 255, 1 << 31, -(1 << 70), 10 ** 400, 0.5, -1e-12, 1e-12,
          1e308, -1e308, 1e17, "", "x", "Z+a", "L99", "good", "3", "\x1b[2J", "\ud800", "\u202e",
          "\0", "../../x", "9" * 5000, "long " * 400, [], [1], [None] * 3, ["x"] * 3, [[]], {},
          {"x": 1}, [1e308] * 3, [10 ** 400] * 3, {"verdict": []},
          {"reason": {}, "verdict": "good"})
# As text, for values that no Python object gives: JSON and literals take them or refuse them.
TOKENS = ("NaN", "Infinity", "-Infinity", "1e999", "[" * 30 + "]" * 30, "[" * 900 + "]" * 900,
          "[" * 3000 + "]" * 3000, '{"a":' * 900 + "1" + "}" * 900, "9" * 4301, "9" * 4290, "nil",
          "set()", "b'x'", "(1, 2", "1j", "-" * 900 + "1", '"\\ud83d"', "'\\ud83d'")
HOLE = "HOLE"
EXTRA = ("reason", "live", "missing", "gyro", "at", "x")
EVENTS = ("ready", "stopped", "calibrating", "solved", "saved", "hello", "selftest", "record",
          "info", "stream", "check", "mounted", "restored", "sample", "capture", "no_record")
ERROR = {"event": "error", "what": "x", "expected": "y"}
STATE = {"event": "state", "state": "moving", "reason": "moving", "left_s": 200, "live": [0] * 6}
ALL = ("state", "sample", "heading")     # said over and over
WIRE = ("prompt", "paste", "ok", "end", "reboot")
MUTATIONS = ("value", "token", "missing", "extra", "renamed")
FLOWS = ("repeated", "late", "half", "bytes", "empty", "twice in a line", "traceback", "another")
ENDLESS = ("drip", "silence", "the same for ever", "noise for ever", "no newline for ever",
           "states for ever", "errors for ever")
KINDS = MUTATIONS + FLOWS + ENDLESS
FILES = (b"", b"null", b"[]", b"1e999", b'{"rate_hz": 1e400, "board": []}', b"\xff\xfe", b"6FLP",
         b'{"board":' * 900 + b"1" + b"}" * 900, b'{"a":' + b"[" * 120 + b"]" * 120 + b"}",
         b"[" * 100000, b'{"rate_hz": true, "x": "\\ud800"}', b'{"n": ' + b"9" * 4400 + b"}",
         b'{"rate_hz": NaN, "sensor": 5}', b"\0" * 500)


def mutated(value, rng, kind):
    """A value with one thing in it changed, somewhere; a placeholder where a token goes."""
    if isinstance(value, (list, tuple)) and value and rng.random() < 0.7:
        items = list(value)
        k = rng.randrange(len(items))
        if kind == "missing":
            del items[k]
        elif kind in ("extra", "renamed"):
            items.insert(k, rng.choice(VALUES))
        else:
            items[k] = mutated(items[k], rng, kind)
        return type(value)(items)
    if isinstance(value, dict) and value:
        fields = dict(value)
        key = rng.choice([key for key in fields if key != "event"] or list(fields))
        if kind == "missing":
            del fields[key]
        elif kind == "extra":
            fields[rng.choice(EXTRA)] = rng.choice(VALUES)
        elif kind == "renamed":
            fields[str(key)[:-1] + "?"] = fields.pop(key)
        else:
            fields[key] = mutated(fields[key], rng, kind)
        return fields
    return HOLE if kind == "token" else rng.choice(VALUES)


class Attack:
    """One kind of malice from some word of the board's on; see KINDS. seed: any number."""

    def __init__(self, seed):
        self.rng = rng = random.Random(seed)
        self.kind = rng.choice(KINDS)
        self.after = rng.choice((0, 0, 1, 2, 3, 5, 8, 20, 60, 120))     # honest words before
        self.chance = rng.choice((1.0, 1.0, 0.3, 0.05))
        self.rare = rng.random() < 0.5      # leaves what is said over and over alone
        self.wire = rng.random() < 0.1      # attacks the raw REPL itself
        self.ended = False
        self.hits = 0
        self.tail = None    # (second, bytes) for ever

    def said(self, name, data, at):
        if self.ended:
            return []
        if (name in WIRE) != self.wire or name == "nothing" or self.rare and name in ALL:
            return [(at, data)]
        self.after -= 1
        if self.after >= 0 or self.rng.random() > self.chance:
            return [(at, data)]
        self.hits += 1
        if self.kind in MUTATIONS:
            return [(at, self.changed(name, data))]
        if self.kind in FLOWS:
            return self.flow(data, at)
        return self.endless(data, at)

    def changed(self, name, data):
        """The line, literal or file with another content."""
        rng = self.rng
        if name in WIRE or name == "id":
            return rng.choice((b"", b"\xff" * 9, b"x" * 70000, b"R\x02", b"\x04\x04>"))
        if "." in name:     # a file in base64
            return base64.b64encode(rng.choice(FILES)) + b"\n"
        lines = data.splitlines()
        k = rng.randrange(len(lines)) if lines else 0
        try:
            literal = name in ("files", "version", "platform", "mpy", "bus")
            value = ast.literal_eval(lines[k].decode()) if literal else json.loads(lines[k])
        except (ValueError, SyntaxError, IndexError):
            return rng.choice((b"", b"()", b"nonsense\n"))
        made = mutated(value, rng, self.kind)
        text = repr(made) if literal else json.dumps(made)
        text = re.sub("[\"']%s[\"']" % HOLE, lambda match: rng.choice(TOKENS), text)
        lines[k] = text.encode("utf-8", "surrogatepass")
        return b"\r\n".join(lines) + b"\r\n"

    def flow(self, data, at):
        rng, kind = self.rng, self.kind
        if kind == "repeated":
            return [(at + 0.01 * k, data) for k in range(rng.choice((2, 5, 300)))]
        if kind == "late":
            return [(at + rng.choice((1, 8, 25, 45, 400)), data)]
        if kind == "half":
            return [(at, data[:len(data) // 2] + rng.choice((b"", b"\r\n")))]
        if kind == "bytes":
            damaged = bytearray(data)
            for _ in range(1 + len(data) // 40):
                if damaged:
                    damaged[rng.randrange(len(damaged))] = rng.randrange(256)
            return [(at, bytes(damaged))]
        if kind == "empty":
            return []
        if kind == "twice in a line":
            return [(at, data.rstrip() + data)]
        if kind == "another":
            return [(at, json.dumps({"event": rng.choice(EVENTS)}).encode() + b"\r\n")]
        return [(at, b"Traceback (most recent call last):\r\n  x\r\nMemoryError: \r\n" + data)]

    def endless(self, data, at):
        """The board's last word: it goes on, without end, whatever it is asked."""
        self.ended = True
        rng = self.rng
        slowly = rng.choice((0.05, 1.0, 20.0))
        line = ERROR if self.kind == "errors for ever" else STATE
        make, step = {
            "silence": (None, 0),
            "drip": (lambda k: data[k % len(data):k % len(data) + 1] or b"x",
                     rng.choice((0.2, 2.0, 9.0, 25.0))),
            "the same for ever": (lambda k: data, slowly),
            "noise for ever": (lambda k: b"noise %d\r\n" % k, slowly),
            "no newline for ever": (lambda k: b"\xff\x00x", rng.choice((0.01, 1.0))),
        }.get(self.kind, (lambda k: json.dumps(dict(line, count=k)).encode() + b"\r\n", 0.25))
        self.tail = make and ((at + step * k, make(k)) for k in itertools.count())
        return []

"""What goes wrong on a bus, and when: a schedule that can be written down as JSON.

One fault is a dict. "kind" is one of
    nak         the address is not acknowledged
    data_nak    a write's data is not acknowledged (the write is lost; SoftI2C stays silent)
    timeout     SCL is held low for one transaction
    stuck_sda   SDA is held low until "pulses" (9) pulses of SCL came
    reset       the chip is as after power-up: asleep, everything at its default
    sleep       the chip falls asleep, its set-up stays
    frozen      the chip answers the same reading for "for_ms"
    unplugged   the chip is gone for "for_ms" (for ever without), then as after power-up
    wrong_id    the identification register answers "value" (0)
    torn        the burst's first "byte" (1) bytes are those of the burst before
    garbled     in the burst's byte "byte" (0) the bits of "bits" (128) are inverted
    duplicate   the burst is the one before once more
    late        the transaction comes "us" (30000) late
    noise       the burst's words are off at random, "counts" (200) being their deviation
When: "at" (transaction number, from 0), or "at_ms" (the world's time), or "every" (each n-th
transaction), or "rate" (probability of each transaction, with "seed"). "count" (1; with
every and rate no limit) is how many transactions are hit. "address": only this chip's. A
fault waits for a transaction it can happen to: garbled for a burst of six or more registers,
torn, duplicate and noise for one of samples, data_nak for a write, wrong_id for a read of the
identification.
"""

from sixflip_sim import noise

KINDS = ("nak", "data_nak", "timeout", "stuck_sda", "reset", "sleep", "frozen", "unplugged",
         "wrong_id", "torn", "garbled", "duplicate", "late", "noise")
_NO_LIMIT = 1 << 30


class _Fault:
    def __init__(self, spec):
        self.kind = spec.get("kind")
        if self.kind not in KINDS:
            raise ValueError("fault %r, expected a kind of %s" % (spec, " ".join(KINDS)))
        self.spec = spec
        self.address = spec.get("address")
        self.at = spec.get("at")
        self.at_ms = spec.get("at_ms")
        self.every = spec.get("every")
        self.rate = spec.get("rate")
        if self.at is None and self.at_ms is None and not self.every and not self.rate:
            raise ValueError("fault %r, expected at, at_ms, every or rate" % spec)
        repeated = self.every or self.rate
        self.left = spec.get("count", _NO_LIMIT if repeated else 1)
        self._key = noise.key(spec.get("seed", 1), 0x600 + KINDS.index(self.kind))

    def hits(self, number, now_us, address):
        if self.address is not None and address != self.address:
            return False
        if self.at is not None:
            return number >= self.at
        if self.at_ms is not None:
            return now_us >= self.at_ms * 1000
        if self.every:
            return number % self.every == self.every - 1
        return noise.uniform(self._key, number) < 2.0 * self.rate - 1.0


class Faults:
    """The schedule of a bus; add() takes one more at any time."""

    def __init__(self, specs=()):
        self.pending = []
        self.spoil_reads = False
        self.tear_at = 1
        self.garble = (0, 128)
        self.wrong_id = 0
        self.noise = 200
        self.happened = []          # (transaction, kind) of everything that was injected
        self._restore = []          # (time in µs, chip, what) of what ends by itself
        for spec in specs:
            self.add(spec)

    def add(self, spec):
        fault = _Fault(spec)
        self.pending.append(fault)
        if fault.kind in ("torn", "garbled", "duplicate", "wrong_id", "noise"):
            self.spoil_reads = True

    def due(self, bus, number, address, register, n, writing):
        """Kinds that hit this transaction, a tuple; those which change the state of chip or
        bus are carried out here."""
        now_us = bus.clock.now_us()
        self._end(now_us)
        active = ()
        for fault in self.pending:
            if not fault.left or not fault.hits(number, now_us, address):
                continue
            chip = _chip_at(bus, address)
            if not _fits(fault.kind, chip, register, n, writing):
                continue
            fault.left -= 1
            self.happened.append((number, fault.kind))
            active = active + (fault.kind,)
            self._carry_out(fault, bus, chip, now_us)
        if self.pending and not self._restore:
            self.pending = [f for f in self.pending if f.left]
        return active

    def _carry_out(self, fault, bus, chip, now_us):
        kind = fault.kind
        spec = fault.spec
        if kind == "stuck_sda":
            bus.stuck_pulses = spec.get("pulses", 9)
        elif kind == "late":
            bus.clock.advance_ns(spec.get("us", 30000) * 1000)
        elif kind == "torn":
            self.tear_at = spec.get("byte", 1)
        elif kind == "garbled":
            self.garble = (spec.get("byte", 0), spec.get("bits", 128))
        elif kind == "noise":
            self.noise = spec.get("counts", 200)
        elif kind == "wrong_id":
            self.wrong_id = spec.get("value", 0)
        elif kind == "reset":
            chip.power_on()
        elif kind == "sleep":
            chip.fall_asleep()
        elif kind in ("frozen", "unplugged"):
            if kind == "frozen":
                chip.frozen = True
            else:
                chip.plugged = False
            if "for_ms" in spec:
                self._restore.append((now_us + spec["for_ms"] * 1000, chip, kind))

    def _end(self, now_us):
        for entry in list(self._restore):
            until, chip, kind = entry
            if now_us >= until:
                self._restore.remove(entry)
                if kind == "frozen":
                    chip.frozen = False
                else:
                    chip.plugged = True
                    chip.power_on()


def _chip_at(bus, address):
    for chip in bus.chips:
        if chip.address == address:
            return chip
    return None


def _fits(kind, chip, register, n, writing):
    """Whether a fault can happen to this transaction of n bytes."""
    if kind in ("nak", "timeout", "stuck_sda", "late"):
        return True
    if chip is None:
        return False
    if kind == "garbled":
        return n >= 6 and not writing
    if kind in ("torn", "duplicate", "noise"):
        return n >= 6 and not writing and register == getattr(chip, "data_register", register)
    if kind == "data_nak":
        return writing
    return kind != "wrong_id" or (register == chip.id_register and not writing)

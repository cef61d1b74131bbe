"""How many samples a file may hold: more of them are read only where --limit asks for it."""

import contextlib
import contextvars
import os

try:
    import resource
except ImportError:         # Windows
    resource = None

from .errors import BadFile, UsageError

USUAL = 10_000_000          # 28 hours at 100 Hz; at 50 bytes a sample half a gigabyte
BYTES = 256                 # unpacked, that a sample may take in a file
MEMORY = 64                 # bytes a sample, of a library that reads files in its own way

STATM = "/proc/self/statm"   # pages that this process has

_limit = contextvars.ContextVar("limit", default=USUAL)


@contextlib.contextmanager
def at_most(samples):
    """While it lasts files may hold so many samples."""
    if not samples > 0:
        raise UsageError("--limit %d: expected a number of samples" % samples)
    before = _limit.set(samples)
    try:
        yield
    finally:
        _limit.reset(before)


def check_samples(path, samples):
    """BadFile for more samples than are allowed; a row without content counts, too."""
    if samples > _limit.get():
        raise BadFile("%s: more than %d rows, expected fewer, or --limit with the number there "
                      "may be" % (path, _limit.get()))


def check_bytes(path, size):
    """BadFile for more bytes, unpacked, than so many samples can need."""
    if size > _limit.get() * BYTES:
        raise BadFile("%s: more than %d MB, unpacked, expected less, or --limit with the number "
                      "of samples there may be" % (path, _limit.get() * BYTES >> 20))


def memory():
    """Bytes that little_memory() leaves."""
    return _limit.get() * MEMORY


@contextlib.contextmanager
def little_memory():
    """While it lasts this process gets no more than memory() on top of what it has, and writes no
    file of more bytes than so many samples can need; where the system knows such limits."""
    if resource is None or not os.path.exists(STATM):
        yield
        return
    with open(STATM) as file:
        now = int(file.read().split()[0]) * resource.getpagesize()
    limits = ((resource.RLIMIT_AS, now + memory()), (resource.RLIMIT_FSIZE, _limit.get() * BYTES))
    before = [(kind, resource.getrlimit(kind)) for kind, _ in limits]
    try:
        for kind, most in limits:
            soft, hard = resource.getrlimit(kind)
            allowed = [limit for limit in (most, soft, hard) if limit != resource.RLIM_INFINITY]
            resource.setrlimit(kind, (min(allowed), hard))
        yield
    finally:
        for kind, both in before:
            resource.setrlimit(kind, both)

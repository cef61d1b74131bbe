"""What a program is at: on stderr, only on a terminal, and only after more than a second."""

import contextlib
import sys
import threading
import time

PATIENCE_S = 1.0

_running = None         # the Stages of the verb under way
_silent = False         # whether this process shows nothing


@contextlib.contextmanager
def during(what):
    """While it lasts a line says what is being done, how many steps are behind and how long it
    has taken. Nothing else may print meanwhile; inside of another one it changes nothing."""
    global _running
    if _running is not None or not sys.stderr.isatty():
        yield
        return
    _running = Stages(what)
    try:
        yield
    finally:
        _running.stop()
        _running = None


def doing(step):
    """The next step of what during() announced, from any thread; without one nothing happens."""
    stages = _running
    if stages is not None:
        stages.next(step)


def silence():
    """In a copy of this process: the line on the terminal is the original's."""
    global _running, _silent
    _running, _silent = None, True


def steps(items, what):
    """Iterate over a sequence; a bar appears once it has taken longer than a second."""
    items = list(items)
    if _silent or not sys.stderr.isatty():
        yield from items
        return
    if _running is not None:
        for done, item in enumerate(items):
            _running.part(what, done, len(items))
            yield item
        return
    start, bar = time.monotonic(), None
    try:
        for done, item in enumerate(items):
            yield item
            if bar is None and time.monotonic() - start > PATIENCE_S:
                bar = _Bar(what, len(items))
            if bar:
                bar.update(done + 1)
    finally:
        if bar:
            bar.stop()


class Stages:
    """The line of during(): `diagnose, 3 steps done: the gyro at rest 0:00:07`."""

    def __init__(self, what):
        self.what, self.step, self.done = what, "", 0
        self.lock, self.progress = threading.Lock(), None
        self.timer = threading.Timer(max(0.0, PATIENCE_S), self.show)
        self.timer.daemon = True
        self.timer.start()

    def words(self):
        behind = "" if self.done < 1 else ", %d step%s done" % (
            self.done, "" if self.done == 1 else "s")
        return self.what + behind + (": " + self.step if self.step else "")

    def show(self):
        from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

        from .terminal import console, plain
        with self.lock:
            if self.timer is None:
                return
            self.progress = Progress(SpinnerColumn("line"), TextColumn("{task.description}"),
                                     TimeElapsedColumn(), console=console(stderr=True),
                                     transient=True)
            self.task = self.progress.add_task(plain(self.words()), total=None)
            self.progress.start()

    def next(self, step):
        with self.lock:
            self.done += bool(self.step)
            self.step = step
            self._redraw()

    def part(self, what, done, total):
        with self.lock:
            self.step = "%s, %d of %d" % (what, done, total)
            self._redraw()

    def _redraw(self):
        from .terminal import plain
        if self.progress:
            self.progress.update(self.task, description=plain(self.words()))

    def stop(self):
        with self.lock:
            self.timer.cancel()
            self.timer = None
            if self.progress:
                self.progress.stop()


class _Bar:
    """One rich progress bar that vanishes when it is done."""

    def __init__(self, what, total):
        from rich.progress import Progress

        from .terminal import console, plain
        self.progress = Progress(console=console(stderr=True), transient=True)
        self.task = self.progress.add_task(plain(what), total=total)
        self.progress.start()

    def update(self, done):
        self.progress.update(self.task, completed=done)

    def stop(self):
        self.progress.stop()

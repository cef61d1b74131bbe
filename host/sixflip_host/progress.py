"""Progress bars: on stderr, only on a terminal, only for what takes longer than a second."""

import sys
import time

PATIENCE_S = 1.0


def steps(items, what):
    """Iterate over a sequence; a bar appears once it has taken longer than a second."""
    items = list(items)
    if not sys.stderr.isatty():
        yield from items
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

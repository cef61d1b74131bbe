"""The last resort of a capture whose file is broken: the poses' sums alone, in a new file."""

from ..flash_files import NEW, remove


def meta_of(root):
    """The metadata in the header of the session's file, or None."""
    from sixflip.capture.scan import Scan
    try:
        with open(root + NEW, "rb") as f:
            return Scan(f).blocks.meta_bytes
    except (OSError, ValueError):
        return None


def write_again(store, placements, complete):
    """A half-written block lies in the way of the old one."""
    store._close()
    meta = store._meta or meta_of(store._root)
    if meta is None:
        return
    remove(store._root + NEW)
    store.kept = 0
    samples = store.samples
    store._open(meta)
    store._writer.samples = samples
    if not store._broken:
        for placement in placements:
            store._writer.pose(placement)
        store._end(complete)

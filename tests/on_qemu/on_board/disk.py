"""A file system for a port that has none: files of the firmware's image, and what is written."""

import io

ENOENT, EIO = 2, 5
FOLDER, FILE = 0x4000, 0x8000
BLOCK, BLOCKS = 4096, 256


class Counted:
    """A file on a flash that is not in the heap: only its length is kept, reading it fails."""

    data = None

    def __init__(self):
        self.size = 0

    def write(self, data):
        self.size += len(data)
        return len(data)

    def tell(self):
        return self.size

    def flush(self):
        pass

    close = flush

    def __enter__(self):
        return self

    def __exit__(self, *error):
        pass


class Small(Counted):
    """One whose content is kept."""

    def __init__(self):
        Counted.__init__(self)
        self.data = b""

    def write(self, data):
        self.data += bytes(data)
        return Counted.write(self, data)


class Disk:
    """For vfs.mount(Disk(given), "/"). given: {path: bytes}, in flash; counted: beginnings of
    names whose content is not kept. written: {path: Small or Counted}."""

    def __init__(self, given, counted=("capture", "refused")):
        self.given = given
        self.counted = counted
        self.written = {}

    def mount(self, readonly, mkfs):
        pass

    def umount(self):
        pass

    def chdir(self, path):
        pass

    def getcwd(self):
        return "/"

    def open(self, path, mode):
        path = path.lstrip("/")
        if "w" in mode:
            made = Counted() if path.startswith(self.counted) else Small()
            self.written[path] = made
            return made
        data = self.given.get(path)
        if data is None:
            if path not in self.written:
                raise OSError(ENOENT)
            data = self.written[path].data
            if data is None:
                raise OSError(EIO)
        return io.BytesIO(data) if "b" in mode else io.StringIO(str(data, "utf-8"))

    def stat(self, path):
        path = path.strip("/")
        if path in self.written:
            return (FILE, 0, 0, 0, 0, 0, self.written[path].size, 0, 0, 0)
        if path in self.given:
            return (FILE, 0, 0, 0, 0, 0, len(self.given[path]), 0, 0, 0)
        if not path or any(
                path + "/__init__" + ending in self.given for ending in (".mpy", ".py")):
            return (FOLDER, 0, 0, 0, 0, 0, 0, 0, 0, 0)
        raise OSError(ENOENT)

    def statvfs(self, path):
        return (BLOCK, BLOCK, BLOCKS, BLOCKS, BLOCKS, 0, 0, 0, 0, 255)

    def remove(self, path):
        if self.written.pop(path.lstrip("/"), None) is None:
            raise OSError(ENOENT)

    def rename(self, old, new):
        old = old.lstrip("/")
        if old not in self.written:
            raise OSError(ENOENT)
        self.written[new.lstrip("/")] = self.written.pop(old)

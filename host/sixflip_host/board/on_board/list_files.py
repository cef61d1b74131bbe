"""Runs on the board: one line (name, size, sha256 in hex or None) for every file.

The host puts in front `wanted`, names to hash or None for all, `staged`, the folder in which the
same names wait for an update, and `alone`: list only those wanted, for on a slow board a walk past
a hundred files takes longer than copying one. Paths start at the working directory, which is the
flash's root wherever it is mounted.
"""

import binascii
import hashlib
import os

buffer = bytearray(512)
view = memoryview(buffer)


def digest(name):
    sha = hashlib.sha256()
    with open(name, "rb") as file:
        while True:
            n = file.readinto(buffer)
            if not n:
                return binascii.hexlify(sha.digest()).decode()
            sha.update(view[:n])


def hashed(name):
    if wanted is None or name in wanted:  # noqa: F821
        return True
    return name.startswith(staged) and name[len(staged):] in wanted  # noqa: F821


def walk(folder):
    for entry in os.ilistdir(folder or "."):
        name = folder + entry[0]
        if entry[1] == 0x4000:
            walk(name + "/")
        else:
            size = entry[3] if len(entry) > 3 else os.stat(name)[6]
            print((name, size, digest(name) if hashed(name) else None))


if alone:  # noqa: F821
    for name in wanted:  # noqa: F821
        print((name, os.stat(name)[6], digest(name)))
else:
    walk("")

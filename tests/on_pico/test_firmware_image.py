"""Where the image is looked for, and one clear line when there is none."""

import pytest

pytest.importorskip("rp2040py")
from sixflip_host import cli  # noqa: E402
from sixflip_host.emulated import emulated_pico  # noqa: E402
from sixflip_host.emulated.emulated_pico import PicoBoard  # noqa: E402
from sixflip_host.errors import NoBoard  # noqa: E402


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """The emulator's cache of a home with nothing in it."""
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv(emulated_pico.IMAGE_NAMED, raising=False)
    folder = tmp_path / ".cache" / "rp2040py"
    folder.mkdir(parents=True)
    return folder


def put(cache, *names):
    for name in names:
        (cache / name).write_bytes(b"UF2\n" + bytes(508))


def test_no_image_is_one_line(cache, capsys):
    assert cli.main(["demo", "--board", "pico"]) == 3
    err = capsys.readouterr().err
    assert "no firmware image" in err
    assert emulated_pico.IMAGE_NAMED in err
    assert err.count("\n") == 1


def test_the_oldest_usable_one_of_the_cache(cache):
    put(cache, "RPI_PICO-20260406-v1.28.0.uf2", "RPI_PICO-20231005-v1.21.0.uf2",
        "RPI_PICO-20230426-v1.20.0.uf2", "RPI_PICO-20260831-v1.30.0-preview.24.g8162451850.uf2",
        "RPI_PICO_W-20231005-v1.21.0.uf2")
    assert emulated_pico.find_image().name == "RPI_PICO-20231005-v1.21.0.uf2"


def test_too_old_is_none(cache):
    put(cache, "RPI_PICO-20230426-v1.20.0.uf2")
    with pytest.raises(NoBoard, match="no firmware image"):
        emulated_pico.find_image()


def test_the_named_one_wins(cache, tmp_path, monkeypatch):
    put(cache, "RPI_PICO-20231005-v1.21.0.uf2")
    put(tmp_path, "mine.uf2")
    monkeypatch.setenv(emulated_pico.IMAGE_NAMED, str(tmp_path / "mine.uf2"))
    assert emulated_pico.find_image().name == "mine.uf2"


@pytest.mark.parametrize("content", [None, b"", b"PK\3\4"])
def test_a_named_one_that_is_no_image_is_said_so(cache, tmp_path, monkeypatch, content):
    path = tmp_path / "mine.uf2"
    if content is not None:
        path.write_bytes(content)
    monkeypatch.setenv(emulated_pico.IMAGE_NAMED, str(path))
    with pytest.raises(NoBoard, match="mine.uf2: expected MicroPython's .uf2"):
        emulated_pico.find_image()


def test_a_file_that_only_begins_like_an_image_does_not_start(cache, tmp_path, capfd):
    put(tmp_path, "mine.uf2")
    with pytest.raises(NoBoard, match="does not run: Invalid UF2 .*mine.uf2"), \
            PicoBoard({}, tmp_path / "flash.bin", tmp_path / "mine.uf2"):
        pass
    assert capfd.readouterr().err == ""


def test_no_emulator_is_one_line(cache, monkeypatch):
    monkeypatch.setattr(emulated_pico.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(NoBoard, match="pip install .*rp2040py"):
        emulated_pico.find_image()

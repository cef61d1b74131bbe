"""Where the project's own files are: in a checkout, or inside the installed package."""

from pathlib import Path

from ..errors import BadFile

HERE = Path(__file__).resolve().parents[1]  # sixflip_host
PACKED = HERE / "_board_files"  # laid out like the checkout: shared/sixflip, device/…


def host_dir():
    """The folder that holds sixflip_sim."""
    return HERE.parent


def tree():
    """The folder that holds shared/ and device/."""
    for candidate in (HERE.parents[1], PACKED):
        if (candidate / "shared" / "sixflip").is_dir() and (candidate / "device").is_dir():
            return candidate
    raise BadFile("%s: the board's files are missing, expected shared/ and device/ beside host/ "
                  "or inside the package; install sixflip again" % HERE)


def shared_dir():
    return tree() / "shared"


def device_dir():
    return tree() / "device"


def board_files():
    """What goes onto a board: {name on the board: path here}, main.py last.

    Names have forward slashes and no leading one.
    """
    files = {}
    for root, package in ((shared_dir(), "sixflip"), (device_dir(), "sixflip_device")):
        for path in sorted((root / package).rglob("*.py")):
            files[path.relative_to(root).as_posix()] = path
    main = device_dir() / "main.py"
    if not main.is_file():
        raise BadFile("%s is missing, install sixflip again" % main)
    files["main.py"] = main
    return files

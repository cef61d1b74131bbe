"""`python -m sixflip_host` and the command `sixflip`: Ctrl-C is one line from the start on."""

import os
import sys


def main():
    """cli.main(), whose imports take most of a short command's time."""
    try:
        from .cli import main as run
        return run()
    except KeyboardInterrupt:
        os.write(2, b"sixflip: stopped\n")
        return 130      # cli.INTERRUPTED, which may not have been imported


if __name__ == "__main__":
    sys.exit(main())

"""`python -m sixflip_host` is the command `sixflip`."""

import sys

from .cli import main

sys.exit(main())

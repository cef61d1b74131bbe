"""`python -m sixflip_host` is the command `sixflip`."""

import sys

from sixflip_host.cli import main

sys.exit(main())

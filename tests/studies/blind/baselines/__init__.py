"""Four ways in common use to look for the cause of a gap, to be beaten in the same run.

Each is called with captures (sixflip_host.capture.capture_file.Capture), one a session, and
returns what `sixflip diagnose --json` would, as far as it can: {"verdict", "causes", "effects"
(names), "gap"}. They share nothing with the diagnosis but the reader of captures.
"""

from .correlation import correlation
from .gaussian_process import gaussian_process
from .lasso import lasso
from .stepwise import stepwise

BASELINES = {"correlation": correlation, "stepwise": stepwise, "lasso": lasso,
             "gaussian process": gaussian_process}

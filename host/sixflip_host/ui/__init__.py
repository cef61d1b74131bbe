"""The guided session in a browser: a small server bound to this machine, and its page."""

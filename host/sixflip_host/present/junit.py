"""The checks of a diagnosis as a JUnit file."""
from xml.sax.saxutils import quoteattr

from .. import atomic_write


def write(path, checks):
    """checks: {name: failure or ""}."""
    lines = ['<?xml version="1.0" encoding="UTF-8"?>',
             '<testsuite name="sixflip diagnose" tests="%d" failures="%d">'
             % (len(checks), sum(bool(f) for f in checks.values()))]
    for name, failure in checks.items():
        lines.append("  <testcase classname=\"sixflip.diagnose\" name=%s%s" % (
            quoteattr(name), "/>" if not failure else "><failure message=%s/></testcase>"
            % quoteattr(failure)))
    lines.append("</testsuite>\n")
    atomic_write.write_bytes(path, "\n".join(lines).encode())

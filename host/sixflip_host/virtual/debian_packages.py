"""Debian packages without root: downloaded with lists of their own, unpacked into a folder."""

import os
import re
import shutil
import subprocess
from pathlib import Path

from ..errors import SixflipError

KEYRING = "/usr/share/keyrings/debian-archive-keyring.gpg"


def cache_dir():
    """SIXFLIP_CACHE, or .cache of the checkout this runs from, or the user's cache."""
    if os.environ.get("SIXFLIP_CACHE"):
        return Path(os.environ["SIXFLIP_CACHE"])
    checkout = Path(__file__).resolve().parents[3]
    if (checkout / "Makefile").exists() and (checkout / "shared" / "sixflip").is_dir():
        return checkout / ".cache"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "sixflip"


def can_unpack():
    """Whether this machine has the programs for it."""
    return bool(shutil.which("apt-get") and shutil.which("dpkg"))


def debian_mirror(instead, apt=Path("/etc/apt")):
    """URI of the first Debian archive in this machine's own apt sources; SixflipError that says
    what to do instead without."""
    places = [apt / "sources.list"] + sorted((apt / "sources.list.d").glob("*"))
    uris = []
    for place in places:
        if place.suffix not in (".list", ".sources") or not place.is_file():
            continue
        text = "\n".join(line for line in place.read_text(errors="replace").splitlines()
                         if not line.lstrip().startswith("#"))
        uris += re.findall(r"^\s*deb\s+(?:\[.*?\]\s*)?(\S+)", text, re.M)
        for line in re.findall(r"^URIs:\s*(.*)$", text, re.M):
            uris += line.split()
    uris = [uri.rstrip("/") for uri in uris if uri.rstrip("/").endswith("/debian")]
    if not uris:
        raise SixflipError("no Debian mirror in this machine's apt sources: " + instead)
    return uris[0]


def prepare(work, suite, instead):
    """Empty lists and archives below work, and the suite's list of packages fetched."""
    for name in ("lists/partial", "archives/partial", "root"):
        (work / name).mkdir(parents=True)
    signed = " [signed-by=%s]" % KEYRING if os.path.exists(KEYRING) else ""
    mirror = debian_mirror(instead)
    (work / "sources.list").write_text("deb%s %s %s main\n" % (signed, mirror, suite))
    apt_get(work, "update")


def apt_get(work, *words):
    """What apt-get says, run with lists and cache of its own below work; SixflipError where it
    fails."""
    options = {
        "Dir::Etc::sourcelist": work / "sources.list", "Dir::Etc::sourceparts": "/dev/null",
        "Dir::State::lists": work / "lists", "Dir::State::status": "/dev/null",
        "Dir::Cache": work / "archives", "APT::Get::List-Cleanup": "0",
        "Acquire::Languages": "none", "Acquire::Retries": "2", "Acquire::http::Timeout": "30",
    }
    if os.geteuid() == 0:
        options["APT::Sandbox::User"] = "root"
    command = ["apt-get", "-q"]
    for key, value in options.items():
        command += ["-o", "%s=%s" % (key, value)]
    answer = subprocess.run(command + list(words), cwd=work, stdin=subprocess.DEVNULL,
                            capture_output=True, text=True, timeout=600)
    if answer.returncode:
        last = (answer.stderr.strip() or answer.stdout.strip() or "no word").splitlines()[-1]
        raise SixflipError("apt-get %s failed: %s" % (words[0], last))
    return answer.stdout


def unpack(work, packages):
    """Download the packages into work and unpack them below work/root."""
    apt_get(work, "download", *packages)
    for package in sorted(work.glob("*.deb")):
        subprocess.run(["dpkg", "-x", str(package), str(work / "root")], check=True, timeout=120)
        package.unlink()
    return work / "root"

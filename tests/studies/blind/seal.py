"""Labels under seal: a manifest with salted hashes, and a file only the scorer opens."""

import hashlib
import json
import secrets

MANIFEST, SEALED = "manifest.json", "sealed.json"


class BrokenSeal(Exception):
    """A label, a salt or a case is not what was sealed."""


def canonical(label):
    """The one way a label is written down for hashing."""
    return json.dumps(label, sort_keys=True, separators=(",", ":"), ensure_ascii=True)


def digest(salt, label):
    return hashlib.sha256((salt + canonical(label)).encode()).hexdigest()


def sealed(cases, kept_out=()):
    """(manifest, sealed) of cases.

    cases: [(public dict with "id", label)]. Every label has a salt of its own, so that two
    equal labels do not show. kept_out: names of families kept out of development; the manifest
    has them by hash.
    """
    manifest = {"format": 1, "cases": [], "kept_out": []}
    secret = {"format": 1, "labels": {}, "kept_out": []}
    for public, label in cases:
        salt = secrets.token_hex(16)
        manifest["cases"].append({**public, "label_sha256": digest(salt, label)})
        secret["labels"][public["id"]] = {"salt": salt, "label": label}
    for name in kept_out:
        salt = secrets.token_hex(16)
        manifest["kept_out"].append(digest(salt, name))
        secret["kept_out"].append({"salt": salt, "name": name})
    return manifest, secret


def write(folder, cases, kept_out=()):
    """Write both files into a folder (pathlib.Path)."""
    for name, content in zip((MANIFEST, SEALED), sealed(cases, kept_out)):
        (folder / name).write_text(json.dumps(content, indent=1))


def opened(folder):
    """{case id: label} after every hash was checked; BrokenSeal with the reason otherwise."""
    manifest = json.loads((folder / MANIFEST).read_text())
    secret = json.loads((folder / SEALED).read_text())
    return checked(manifest, secret)


def checked(manifest, secret):
    """{case id: label} of a manifest and what was sealed with it; BrokenSeal otherwise."""
    hashes = {case["id"]: case["label_sha256"] for case in manifest["cases"]}
    if len(hashes) != len(manifest["cases"]):
        raise BrokenSeal("two cases have one id")
    if set(hashes) != set(secret["labels"]):
        raise BrokenSeal("the cases of the manifest are not those of the labels: %s"
                         % ", ".join(sorted(set(hashes) ^ set(secret["labels"]))))
    for name, entry in secret["labels"].items():
        if digest(entry["salt"], entry["label"]) != hashes[name]:
            raise BrokenSeal("the label of case %s is not the one that was sealed" % name)
    families = [digest(f["salt"], f["name"]) for f in secret["kept_out"]]
    if families != manifest["kept_out"]:
        raise BrokenSeal("the families kept out are not those that were sealed")
    return {name: entry["label"] for name, entry in secret["labels"].items()}

"""The SDF of a diagnosis against Debian's own description of SDF 1.7 (package sdformat-sdf)."""
import glob
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np

from sixflip_host.export import put_back, put_back_native
from tests import debian_tier

FOLDERS = "/usr/share/sdformat*/1.7"


def folder():
    try:
        debian_tier.install(["sdformat-sdf"],
                            lambda: [] if glob.glob(FOLDERS) else ["sdformat-sdf"])
    except debian_tier.Unavailable as error:
        debian_tier.without("SDF schema", error)
    return Path(sorted(glob.glob(FOLDERS))[-1])


def described(description, name, where):
    """The description of a child element, in the file it is included from where it is."""
    for child in description.findall("element"):
        if child.get("name") == name:
            return child
    for include in description.findall("include"):
        found = ElementTree.parse(where / include.get("filename")).getroot()
        if found.get("name") == name:
            return found
    return None


def check(element, description, where):
    """Every element is known, has a value of its type, and all that is required is there."""
    kind = description.get("type")
    if kind == "double":
        float(element.text)
    if kind == "pose":
        assert len([float(x) for x in element.text.split()]) == 6
    for attribute in description.findall("attribute"):
        if attribute.get("required") == "1":
            assert element.get(attribute.get("name")) is not None, element.tag
    for child in element:
        known = described(description, child.tag, where)
        assert known is not None, "%s in %s" % (child.tag, element.tag)
        check(child, known, where)
    for child in description.findall("element"):
        if child.get("required") in ("1", "+"):
            assert element.find(child.get("name")) is not None, child.get("name")


def test_every_element_is_one_that_debians_sdformat_describes():
    where = folder()
    triad = put_back.Triad(bias=np.array([0.1, -0.2, 0.3]), noise=np.full(3, 0.004),
                           step=np.array([0.0, 0.01, 0.0]))
    text = put_back_native.gz(put_back.PutBack(
        triad, triad, np.array([0.04, 0.0, 0.01]), 100.0, 25.0))
    sensor = ElementTree.fromstring(text).find("model/link/sensor")
    check(sensor, ElementTree.parse(where / "sensor.sdf").getroot(), where)
    noise = sensor.find("imu/angular_velocity/y/noise")
    assert noise.get("type") == "gaussian_quantized" and float(noise.find("mean").text) == -0.2

"""umockdev, or one line why not."""

import pytest

from tests.debian_tier import Unavailable, without

from .device_node import provide


@pytest.fixture(scope="session", autouse=True)
def umockdev():
    try:
        provide()
    except Unavailable as error:
        without("device node of a Raspberry Pi", error)

"""What is said of real recordings; without the recordings these tests are left out."""

import pytest

from tests.studies.robustness.unattended import ROWS, Heard


@pytest.mark.long
@pytest.mark.parametrize("name", ROWS)
def test_what_is_known_of_a_recording_is_said(name, recordings):
    captures, known = ROWS[name]
    heard = Heard(captures(recordings))
    assert [what for what, holds in known if not holds(heard)] == [], heard.answer["causes"]

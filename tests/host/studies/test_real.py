"""The recordings that nobody here made, in short: no claim that a plain computation contradicts,
nothing left out that it shows at five standard errors. All of them: `make real`."""
import pytest

from tests.studies.real import real_recordings, real_run

SHORT = [one for one in real_recordings.RECORDINGS if one.short]


@pytest.fixture(scope="module")
def judged(tmp_path_factory, once):
    """Function of a recording and the folder of all: (answer, [(claim, figure, right)]) of
    real_run.judged, once each."""
    def of(recording, recordings):
        def make():
            answer, rows = real_run.judged(recording, recordings, tmp_path_factory.mktemp("real"))
            return answer, [(row.claim, row.figure, None if row.right is None else bool(row.right))
                            for row in rows]
        return once(recording.name, make)
    return of


@pytest.mark.long
@pytest.mark.parametrize("recording", SHORT, ids=[one.name for one in SHORT])
def test_every_claim_stands_beside_a_plain_figure(recording, recordings, judged):
    answer, rows = judged(recording, recordings)
    wrong = ["%s | %s" % (claim, figure) for claim, figure, right in rows if right is False]
    assert answer["verdict"]
    assert not wrong, "\n".join(wrong)


@pytest.mark.long
def test_temperature_takes_the_sweep_to_what_a_cubic_leaves_or_less(recordings, judged):
    answer, _ = judged(real_run.BY_NAME["tofupilot, one rest"], recordings)
    names = {(c["sensor"], name) for c in answer["causes"] for name in c["class"]}
    assert ("accel", "thermal_bias") in names and ("accel", "warm_up") not in names
    z, y = answer["gap"]["accel"]["axes"]["z"], answer["gap"]["gyro"]["axes"]["y"]
    assert 18.0 < z["before"] < 22.0 and z["after"] < 4.6  # mg: 19.3 and 4.6 by a cubic
    assert 0.95 < y["before"] < 1.1 and y["after"] < 0.06  # deg/s: 1.02 and 0.055

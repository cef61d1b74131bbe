"""What happens inside the rests counts, too: a slow ripple, single samples that jump."""
import numpy as np
import pytest

from sixflip_host.diagnosis import answer, diagnosis
from sixflip_host.experiment import blocks
from sixflip_host.simulation import scenario, simulated_session


@pytest.fixture(scope="module")
def captures():
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 21,
                               "world": {"placement_scatter_deg": 0.05}})
    found = [simulated_session.session(plan, k) for k in range(len(plan.worlds))]
    for capture in found:   # the accelerometer alone: half the work
        capture.gyro = None
    return found


def diagnosed(captures, change):
    """The answer on captures whose accelerometer counts change(t, counts, generator) changes."""
    sessions, restored = [], []
    for number, capture in enumerate(captures):
        kept, t = capture.accel, (capture.t_us - capture.t_us[0]) * 1e-6
        changed = kept.astype(float)
        change(t, changed, np.random.default_rng(number))
        capture.accel = np.rint(changed).astype(np.int16)
        sessions.append(blocks.session_of(str(number), capture))
        restored.append(kept)
    found = answer.as_dict(diagnosis.diagnose_sessions(sessions, diagnosis.Settings(jobs=1)))
    for capture, kept in zip(captures, restored):
        capture.accel = kept
    return found


def test_a_slow_ripple_of_8_mg_is_a_line_at_its_frequency(captures):
    def ripple(t, counts, generator):
        counts[:, 0] += 8e-3 * 16384 * np.sin(2.0 * np.pi * 1.03 * t)
    found = diagnosed(captures, ripple)
    cause, = found["causes"]
    assert cause["effect"] == "vibration" and cause["axes"] == ["x"]
    assert cause["value"]["x"] == pytest.approx(8.0, rel=0.1)
    assert any("1.0300 Hz" in remark for remark in found["remarks"])
    assert cause["hz"]["x"] == pytest.approx(1.03, abs=0.05)


def test_a_ripple_as_slow_as_the_rests_is_a_line_and_no_drift(captures):
    """It leaks all over the spectrum of rests with gaps between them, and moves their means."""
    def ripple(t, counts, generator):
        counts[:, 2] += 6e-3 * 16384 * np.sin(2.0 * np.pi * t / 6.4)
    found = diagnosed(captures, ripple)
    cause, = found["causes"]
    assert cause["effect"] == "vibration" and cause["axes"] == ["z"]
    assert cause["value"]["z"] == pytest.approx(6.0, rel=0.2)
    assert cause["hz"]["z"] == pytest.approx(1.0 / 6.4, abs=0.002)


def test_a_tone_that_wanders_is_a_gap_in_frequency(captures):
    """It is a line of no one frequency, and was no gap."""
    def chirp(t, counts, generator):
        hz = 5.0 + 30.0 * (t / 90.0 % 1.0)
        counts[:, 1] += 5e-3 * 16384 * np.sin(2.0 * np.pi * np.cumsum(hz) * 0.01)
    found = diagnosed(captures, chirp)
    assert found["verdict"] == "unexplained"
    assert (found["where"][0]["axis"], found["where"][0]["domain"]) == ("y", "frequency")
    assert any("a tone that wanders" in remark for remark in found["remarks"])


def test_one_of_many_tones_is_no_vibration(captures):
    """As a converter's idle tones, which leap: the strongest was a vibration that explained all,
    with a third of the power."""
    def idle(t, counts, generator):
        hz = np.array([7.0, 32.0, 13.0, 21.0, 44.0])[(t / 5.7).astype(int) % 5]
        counts[:, 1:] += 5e-3 * 16384 * np.sin(2.0 * np.pi * np.cumsum(hz) * 0.01)[:, None]
    found = diagnosed(captures, idle)
    assert found["verdict"] == "unexplained" and found["causes"] == []
    assert {w["axis"] for w in found["where"] if w["domain"] == "frequency"} == {"y", "z"}
    assert any("a tone that wanders" in remark for remark in found["remarks"])


def test_what_comes_and_goes_at_a_frequency_that_wanders_is_one_vibration(captures):
    """A fan: its bump is wider than the lobe of a line, and was three quarters of itself."""
    def fan(t, counts, generator):
        hz = 23.0 + np.convolve(generator.standard_normal(len(t)), np.full(300, 0.02), "same")
        loud = 1.0 + 0.5 * np.sin(2.0 * np.pi * 0.3 * t)
        counts[:, 2] += 9e-3 * 16384 * loud * np.sin(2.0 * np.pi * np.cumsum(hz) * 0.01)
    found = diagnosed(captures, fan)
    cause, = found["causes"]
    assert found["verdict"] == "explained" and cause["class"] == ["vibration"]
    assert cause["axes"] == ["z"] and cause["share"] > 0.9
    assert cause["value"]["z"] == pytest.approx(9.0 * np.sqrt(1.0 + 0.5 ** 2 / 2.0), rel=0.1)


@pytest.mark.parametrize("mg, hz", [(0.85, 17.3), (6.0, 31.3)])
def test_a_line_over_noise_that_is_no_gap_is_all_there_is(captures, mg, hz):
    """By the power of all of the spectrum a weak line, and one over noise that falls with the
    frequency, were a part of something else."""
    def line(t, counts, generator):
        counts[:, 0] += mg * 16.384 * np.sin(2.0 * np.pi * hz * t)
        if mg > 1.0:
            slow = generator.standard_normal(len(t))
            for i in range(1, len(t)):
                slow[i] = 0.9 * slow[i - 1] + 0.43 * slow[i]
            counts[:, 0] += 2.0 * 16.384 * slow
    found = diagnosed(captures, line)
    cause, = found["causes"]
    assert found["verdict"] == "explained" and cause["effect"] == "vibration"
    assert cause["share"] > 0.9


def test_multiples_of_a_line_are_its_own(captures):
    def motor(t, counts, generator):
        for times, mg in ((1, 8.0), (2, 4.0), (4, 3.0)):
            counts[:, 1] += mg * 16.384 * np.sin(2.0 * np.pi * times * 18.7 * t)
    found = diagnosed(captures, motor)
    cause, = found["causes"]
    assert found["verdict"] == "explained" and cause["share"] > 0.9


def test_axes_that_are_swapped_in_one_session_alone_are_named(captures):
    """Its labels contradicted gravity, and nothing was named."""
    second = iter((False, True))

    def swap(t, counts, generator):
        counts[:, 2] += 0.03 * 16384 * np.exp(-t / 200.0)
        if next(second):
            counts[:, :2] = counts[:, 1::-1].copy()
    found = diagnosed(captures, swap)
    named = {cause["effect"] or tuple(cause["class"]): cause for cause in found["causes"]}
    swapped = named.pop("axis_swap")
    assert swapped["value"] == {"x": 2, "y": 1}
    assert any("in 1 alone" in remark for remark in found["remarks"])
    other, = named.values()  # the rests of both are judged beside it
    assert "warm_up" in other["class"] and other["axes"] == ["z"]


def test_each_order_of_axes_is_told_of_its_own_sessions(captures):
    first = iter((True, False))

    def swap(t, counts, generator):
        if next(first):
            counts[:, 2] *= -1.0
        else:
            counts[:, :2] = counts[:, 1::-1].copy()
    found = diagnosed(captures, swap)
    orders = [cause["value"] for cause in found["causes"] if cause["effect"] == "axis_swap"]
    assert sorted(orders, key=len) == [{"z": -3}, {"x": 2, "y": 1}]
    assert any("in 0 alone" in remark for remark in found["remarks"])


def test_spikes_in_one_percent_of_the_samples_are_a_gap(captures):
    def spikes(t, counts, generator):
        hit = generator.random(len(t)) < 0.01
        counts[hit, 1] += 256.0 * generator.choice([-1.0, 1.0], hit.sum())
    found = diagnosed(captures, spikes)
    assert found["verdict"] in ("unexplained", "partly explained")
    assert found["where"][0]["domain"] == "noise"
    assert any("spikes" in remark for remark in found["remarks"])


def growing(t, counts, generator):
    counts += (3e-3 * 16384 * 3.0 * t / t[-1])[:, None] * generator.standard_normal(counts.shape)


def louder_with_y_up(t, counts, generator):
    counts[:, 1] += 6.0 * 16.384 * np.clip(counts[:, 1] / 16384.0, 0.0, 1.0) * (
        generator.standard_normal(len(t)))


@pytest.mark.parametrize("noise, words", [
    (growing, "at the end of a session"), (louder_with_y_up, "with y up")])
def test_noise_that_goes_with_time_or_an_axis_that_is_up_is_a_gap(captures, noise, words):
    found = diagnosed(captures, noise)
    assert found["verdict"] in ("unexplained", "partly explained")
    assert found["where"][0]["domain"] == "noise" and not found["causes"]
    assert any(words in remark for remark in found["remarks"])


def test_noise_of_the_surroundings_along_the_vertical_goes_with_neither_end(captures):
    """Whichever end is up: what a desk does, and is heard by a quiet chip."""
    def shaking(t, counts, generator):
        counts += 3.0 * 16.384 * np.abs(counts / 16384.0) * generator.standard_normal(counts.shape)
    found = diagnosed(captures, shaking)
    assert not any("up is" in remark for remark in found["remarks"])


def test_without_either_there_is_no_gap(captures):
    found = diagnosed(captures, lambda t, counts, generator: None)
    assert found["verdict"] == "no gap" and not found["where"]


def test_what_rings_out_after_each_move_is_no_vibration(captures):
    """Three times as large it was a vibration and explained all, smaller it was no gap."""
    def ringing(mg):
        def change(t, counts, generator):
            for run in runs[len(counts)]:
                since = t[run.first:run.end] - t[run.first]
                counts[run.first:run.end, 0] += mg * 16.384 * np.exp(-since / 1.2) * np.sin(
                    2.0 * np.pi * 2.0 * since)
        return change
    runs = {len(c): blocks.session_of("", c).runs for c in captures}
    for mg in (15.0, 45.0):
        found = diagnosed(captures, ringing(mg))
        assert found["verdict"] == "unexplained" and found["causes"] == []
        assert {(w["axis"], w["domain"]) for w in found["where"]} >= {("x", "time_since_move")}
        assert any("rings" in remark for remark in found["remarks"])


def test_noise_of_the_usual_size_may_have_any_shape(captures):
    """A supply that two axes share moves them together: that was a gap without a name, although
    what was left was no more than the samples' own noise."""
    def shared(t, counts, generator):
        counts += 60.0 * generator.standard_normal(len(t))[:, None] * np.array([1.0, 1.0, 0.0])
    found = diagnosed(captures, shared)
    assert found["verdict"] == "no gap" and not found["where"]

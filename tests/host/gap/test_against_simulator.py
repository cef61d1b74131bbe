"""What the simulator has as well is no gap: equality of two sizes by their intervals, and what the
simulator's own log says and cannot say passed on."""
from types import SimpleNamespace

import pytest

from sixflip_host.diagnosis.simulator import against_simulator


def finding(value, half=None, effect="quantisation", sensor="accel", domain="samples"):
    interval = None if half is None else {k: (v - half, v + half) for k, v in value.items()}
    return SimpleNamespace(effect=effect, sensor=sensor, value=value, interval=interval,
                           domain=domain, lines=())


def simulator(*findings, motion=None):
    return against_simulator.Simulator(SimpleNamespace(
        findings=list(findings), motion=motion, sessions=()), {}, ())


@pytest.mark.parametrize("value,half,new", [
    ({"x": 10.0}, 1.0, False), ({"x": 12.0}, 1.0, False), ({"x": 12.0}, 0.1, True),
    ({"x": 14.0}, 1.0, True), ({"x": 14.0}, 3.0, False),
    ({"x": 10.0, "z": 6.0}, 1.0, True), ({"x": 10.0, "z": 1.0}, 1.0, False),
    ({"x": 10.3}, 0.01, False)], ids=str)  # as much as the scale of a part is off
def test_two_sizes_are_equal_as_far_as_their_intervals_say(value, half, new):
    own = simulator(finding({"x": 10.0}, half))
    assert own.new(finding(value, half), ()) is new


def test_another_sensor_or_effect_is_another_finding():
    own = simulator(finding({"x": 10.0}, 1.0))
    assert own.new(finding({"x": 10.0}, 1.0, sensor="gyro"), ())
    assert own.new(finding({"x": 10.0}, 1.0, effect="dead_zone"), ())


def test_what_only_the_simulator_has_is_passed_on():
    line, step = finding({"x": 10.0}), finding({"x": 4.0}, effect="dead_zone")
    assert simulator(line, step).only_simulated([finding({"x": 9.0})], ()) == [step]


def test_a_log_that_shows_nothing_of_what_acts_in_motion_is_not_said_to_lack_it():
    arm = finding({"x": 4.0}, 0.5, effect="lever_arm", domain="motion")
    assert not simulator().shows(arm)
    assert simulator(motion="judged").shows(arm)
    assert simulator().shows(finding({"x": 10.0}))
    own = simulator(arm, finding({"x": 10.0}), motion="judged")
    assert own.only_simulated([], (), in_motion=False) == [own.diagnosis.findings[1]]
    assert own.only_simulated([], ()) == own.diagnosis.findings


def test_the_simulators_remarks_and_silent_effects_are_passed_on(monkeypatch):
    monkeypatch.setattr(against_simulator.detectable, "listed", lambda found: [
        {"effect": "cubic"}, {"effect": "creep"}])
    found = SimpleNamespace(
        gaps={"accel": None}, remarks=["its clock stands still", "its x never changes"],
        causes=[("accel", SimpleNamespace(effect="thermal_bias"))])
    assert against_simulator._remarks(found, ["its x never changes"]) == [
        "the simulator already has: thermal_bias",
        "the simulator's log: its clock stands still",
        "effects that the simulator's log cannot show: creep, cubic"]
    found.gaps = {}
    assert "too few poses" in against_simulator._remarks(found, [])[0]

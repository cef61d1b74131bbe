"""`sixflip diagnose --sim` with logs that are not as they should be: what can be said is said."""
import json
import struct

import numpy as np
import pytest
from scipy import signal

import sixflip_host
from sixflip_host import cli
from sixflip_host.capture import capture_file
from sixflip_host.diagnosis.diagnose import diagnose
from sixflip_host.diagnosis.simulator import comparison, parameters

G = 9.80665


def turning(seed, seconds=30.0, rate_hz=100.0, rests=True):
    """(t, force, rate) of a box that is turned about two axes, with rests."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, 1.0 / rate_hz)
    rate = np.zeros((len(t), 3))
    for k in range(int(seconds // 5)):
        inside = (t > 5 * k + (2.0 if rests else 0.0)) & (t < 5 * k + 5)
        phase = np.pi * (t[inside] - t[inside][0]) / 3.0
        rate[inside] += np.sin(phase)[:, None] ** 2 * rng.uniform(-1.5, 1.5, 3)
    up, force = np.array([0.0, 0.0, 1.0]), np.empty_like(rate)
    for i, w in enumerate(rate):
        up = up - np.cross(w, up) / rate_hz
        up /= np.linalg.norm(up)
        force[i] = G * up
    return t, force, rate


def capture(path, t, force, rate, noise=1.0, seed=0, constant=None):
    rng = np.random.default_rng(seed)
    accel = np.round((force + noise * 0.03 * rng.normal(size=force.shape)) * 8192 / G)
    gyro = np.round(np.degrees(rate + noise * 0.001 * rng.normal(size=rate.shape)) * 65.5)
    if constant is not None:
        gyro[:, constant] = 0
    head = {"sensor": "mpu6050", "rate_hz": 1.0 / (t[1] - t[0]), "accel_lsb_per_g": 8192,
            "gyro_lsb_per_dps": 65.5}
    rows = np.column_stack([np.round(1e6 * t), accel, gyro]).astype(int)
    path.write_text("# sixflip-capture 1\n# %s\nt_us,ax,ay,az,gx,gy,gz\n%s\n" % (
        json.dumps(head), "\n".join(",".join(map(str, row)) for row in rows.tolist())))
    return str(path)


def diagnosed(capsys, real, *sims):
    asked = [word for sim in sims for word in ("--sim", sim)]
    assert cli.main(["diagnose", real, *asked, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.fixture
def real(tmp_path):
    return capture(tmp_path / "real.csv", *turning(1))


def test_another_motion_is_not_taken_for_the_same(real, tmp_path, capsys):
    answer = diagnosed(capsys, real, capture(tmp_path / "sim.csv", *turning(2), seed=5))
    assert not answer["simulator"]["logs"][0]["same_motion"]
    assert answer["simulator"]["conventions"] == []
    assert answer["simulator"]["unseen"]


def test_logs_of_different_rates_are_compared_on_one_grid(real, tmp_path, capsys):
    answer = diagnosed(capsys, real, capture(tmp_path / "sim.csv", *turning(1, rate_hz=250.0),
                                             seed=5))
    log = answer["simulator"]["logs"][0]
    assert log["same_motion"] and "250" in " ".join(log["remarks"])
    assert answer["simulator"]["conventions"] == []


@pytest.mark.long
def test_what_the_simulator_lacks_of_the_sensor_is_no_convention(tmp_path, capsys):
    """A gyro with other scales up and down, and a rate that is heard in the accelerometer: the
    one was a convention without a name, the other a centripetal term that was left out."""
    t, force, rate = turning(1, seconds=60.0)
    real = capture(tmp_path / "real.csv", t, force, rate + 0.016 * np.abs(rate))
    assert diagnosed(capsys, real, capture(tmp_path / "sim.csv", t, force, rate, seed=5))[
        "simulator"]["conventions"] == []
    heard = force + rate[:, [2, 0, 1]] * [0.6, -0.4, 0.3]
    real = capture(tmp_path / "heard.csv", t, heard, rate)
    found = diagnosed(capsys, real, capture(tmp_path / "sim.csv", t, force, rate, seed=5))[
        "simulator"]["conventions"]
    assert [(c["name"], c["sensor"]) for c in found] == [("unknown", "accel")]


def test_a_constant_channel_is_named(real, tmp_path, capsys):
    answer = diagnosed(capsys, real, capture(tmp_path / "sim.csv", *turning(1), seed=5,
                                             constant=1))
    found = answer["simulator"]["conventions"]
    assert [(c["name"], c["sensor"]) for c in found] == [("constant_channel", "gyro")]


def test_a_simulator_without_noise_has_another_noise(real, tmp_path, capsys):
    answer = diagnosed(capsys, real, capture(tmp_path / "sim.csv", *turning(1), noise=0.0))
    noise = answer["simulator"]["parameters"]["accel"]["noise_density"]["x"]
    assert noise["differs"] and noise["simulator"] == 0.0
    assert noise["set"] == pytest.approx(noise["real"], rel=1e-3)


def test_without_a_rest_and_without_an_overlap_that_is_said(real, tmp_path, capsys):
    restless = capture(tmp_path / "sim.csv", *turning(3, rests=False), seed=5)
    short = [x[:600] for x in turning(4)]
    answer = diagnosed(capsys, real, restless, capture(tmp_path / "short.csv", *short, seed=6))
    assert len(answer["simulator"]["logs"]) == 2
    assert not any(log["same_motion"] for log in answer["simulator"]["logs"])


def test_the_words_fit_a_terminal_and_the_report_has_its_page(real, tmp_path, capsys):
    t, force, rate = turning(1)
    sim = capture(tmp_path / "sim.csv", t, -force, rate, seed=5)
    report = tmp_path / "report"
    assert cli.main(["diagnose", real, "--sim", sim, "--report", str(report)]) == 0
    assert "sign turned" in capsys.readouterr().out.splitlines()[0]
    page = (report / "index.html").read_text()
    for heading in ("conventions", "Parameters side by side", "What it does to a robot",
                    "Settings to paste", "Real, simulated, and simulated with what was found"):
        assert heading in page


def test_what_both_have_is_no_gap_though_the_simulators_axes_are_swapped(tmp_path, capsys):
    paths = []
    for name, seed in (("real", 3), ("sim", 4)):
        log = sixflip_host.simulate({"seed": seed, "scene": "paper", "effects": [
            {"effect": "quantisation", "sensor": "accel", "x": 16, "y": 16, "z": 16}]})[0]
        if name == "sim":
            log.gyro = log.gyro[:, [1, 0, 2]]
        paths.append(str(tmp_path / (name + ".csv")))
        capture_file.write(paths[-1], log)
    answer = diagnosed(capsys, *paths)
    assert [c["name"] for c in answer["simulator"]["conventions"]] == ["gyro_axes"]
    assert "quantisation" not in [c["effect"] for c in answer["causes"]]


def bag(path, t, force, rate):
    """A ROS 1 bag of sensor_msgs/Imu, by rosbags' own writer."""
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores, get_typestore
    store = get_typestore(Stores.ROS1_NOETIC)
    kind = store.types
    vector, none = kind["geometry_msgs/msg/Vector3"], np.zeros(9)
    with Writer(path) as writer:
        topic = writer.add_connection("/imu", "sensor_msgs/msg/Imu", typestore=store)
        for at, f, w in zip(t, force, rate):
            ns = 10 ** 18 + int(round(1e9 * at))
            stamp = kind["builtin_interfaces/msg/Time"](ns // 10 ** 9, ns % 10 ** 9)
            message = kind["sensor_msgs/msg/Imu"](
                kind["std_msgs/msg/Header"](0, stamp, "imu"),
                kind["geometry_msgs/msg/Quaternion"](0, 0, 0, 1), none, vector(*w), none,
                vector(*f), none)
            writer.write(topic, ns, store.serialize_ros1(message, topic.msgtype))
    return str(path)


def ulog(path, t, force, rate):
    """sensor_combined of a flight log, by the format's description."""
    def message(kind, data):
        return struct.pack("<HB", len(data), ord(kind)) + data
    text = b"sensor_combined:uint64_t timestamp;float[3] gyro_rad;float[3] accelerometer_m_s2;"
    rows = [message("D", struct.pack("<HQ6f", 7, int(5e6 + 1e6 * at), *w, *f))
            for at, f, w in zip(t, force, rate)]
    path.write_bytes(b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0) + message("B", bytes(40))
                     + message("F", text) + message("A", struct.pack("<BH", 0, 7)
                                                    + b"sensor_combined") + b"".join(rows))
    return str(path)


def noisy(t, force, rate, seed):
    rng = np.random.default_rng(seed)
    return (t, force + 0.03 * rng.normal(size=force.shape),
            rate + 0.001 * rng.normal(size=rate.shape))


@pytest.mark.long
def test_a_flight_log_is_held_against_a_simulators_bag(tmp_path, capsys):
    """Directly, of logs that only turn: with its sign wrong, its steps of time are not, too."""
    t, force, rate = turning(1)
    real = ulog(tmp_path / "real.ulg", *noisy(t, force, rate, 1))
    healthy = bag(tmp_path / "sim.bag", *noisy(t, force, rate, 2))
    turned = bag(tmp_path / "turned.bag", *noisy(t, -force, rate, 3))
    answer = diagnosed(capsys, real, healthy, turned)
    assert [log["same_motion"] for log in answer["simulator"]["logs"]] == [True, True]
    assert [(c["name"], c["log"]) for c in answer["simulator"]["conventions"]] == [
        ("force_sign", turned)]
    assert cli.main(["diagnose", real, "--sim", healthy, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["verdict"] == "no gap"


def driving(seed, rate_hz=100.0):
    """(t, force, rate) of a robot that drives and turns on a floor, and creeps on in yaw after it
    has stopped; nothing pitches or rolls it."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 60.0, 1.0 / rate_hz)
    rate = np.zeros((len(t), 3))
    for first in np.arange(4.0, 58.0, 6.0):
        way = (t >= first) & (t < first + 2.0)
        rate[way, 2] = rng.uniform(-1.5, 1.5) * np.sin(np.pi * (t[way] - first) / 2.0) ** 2
        rest = (t >= first + 2.0) & (t < first + 6.0)
        rate[rest, 2] = np.radians(rng.uniform(-0.3, 0.3)) * np.exp(first + 2.0 - t[rest])
    force = np.tile([0.0, 0.0, G], (len(t), 1))
    force[:, 0] += 0.5 * np.sin(0.7 * t) * (np.abs(rate[:, 2]) > 0.2)
    return t, force, rate


@pytest.mark.long
def test_a_robot_that_never_leaves_its_wheels_is_not_in_poses(tmp_path, capsys):
    """However many rests it has: what its body does in them is no drift of its gyro."""
    answer = diagnosed(capsys, capture(tmp_path / "real.csv", *driving(1)),
                       capture(tmp_path / "sim.csv", *driving(1), seed=5))
    assert answer["verdict"] == "no gap"
    assert any("settles" in said for said in answer["remarks"])


@pytest.mark.long
def test_a_bump_that_one_log_is_cut_off_at_is_no_gap(tmp_path):
    """The other one stops at no other range: it has not been there."""
    logs = []
    for name, counts, seed in (("real", 32767, 0), ("sim", 32000, 5)):
        log = capture_file.read(capture(tmp_path / name, *driving(1), seed=seed))
        log.accel[500, 2] = counts
        logs.append((name, log))
    found = diagnose(logs[:1], logs[1:])
    assert not found.findings
    assert not [p for c in found.comparisons for p in c.differs if p.name == "range"]


def test_a_channel_that_hears_nothing_but_noise_has_no_scale_and_no_axes(tmp_path):
    """On a floor four of six channels do: two logs of one robot have nothing there to share."""
    real, sim = (capture_file.read(capture(tmp_path / str(seed), *driving(1), seed=seed))
                 for seed in (0, 5))
    found = comparison.compare([("real", real)], "sim", sim)
    assert found.alignment.same
    assert not found.conventions and not found.differs


def rumbling(seed, floor):
    """(t, force, rate) of a rover that drives, turns and sways by less than a degree; the floor
    (a seed) shakes it on its way, faster than it moves."""
    rng, own = np.random.default_rng(seed), np.random.default_rng(floor)
    t = np.arange(0.0, 200.0, 0.01)
    way = np.clip(np.minimum(t % 40.0 - 8.0, 38.0 - t % 40.0) / 1.5, 0.0, 1.0)
    way = (way ** 2 * (3.0 - 2.0 * way))[:, None]

    def shaking(low, high, generator):
        band = signal.butter(2, [low, high], "bandpass", fs=100.0, output="sos")
        x = signal.sosfiltfilt(band, generator.standard_normal((len(t), 3)), axis=0)
        return way * x / x.std(axis=0)

    roll, pitch = np.radians(0.4) * shaking(0.2, 2.0, rng)[:, :2].T
    speed = way[:, 0] * (0.35 + 0.2 * np.sin(0.5 * t + rng.uniform(0.0, 6.0)))
    yaw = way[:, 0] * np.radians(40.0) * np.sin(0.31 * t + rng.uniform(0.0, 6.0))
    rate = np.stack([np.gradient(roll, t) - yaw * pitch, np.gradient(pitch, t) + yaw * roll,
                     yaw], 1)
    force = G * np.stack([-pitch, roll, np.ones_like(t)], 1)
    force[:, :2] += np.stack([np.gradient(speed, t), speed * yaw], 1)
    return (t, force + 0.25 * shaking(5.0, 40.0, own),
            rate + np.radians(0.3) * shaking(5.0, 40.0, own))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_floor_that_shakes_each_log_in_its_own_way_is_no_convention(tmp_path, seed):
    """The simulator's was "at the body's centre", "smoother than the sensor"."""
    real, sim = (capture_file.read(capture(tmp_path / str(floor), *rumbling(seed, floor),
                                           noise=0.5, seed=floor)) for floor in (11, 12))
    found = comparison.compare([("real", real)], "sim", sim)
    assert found.alignment.same
    assert not found.conventions and not found.differs


def names(answer):
    return [c["name"] for c in answer["simulator"]["conventions"]]


def test_another_drive_on_a_floor_tells_no_frame_of_the_gyro(tmp_path, capsys):
    """About the vertical a rate is the same in the body and in the world."""
    answer = diagnosed(capsys, capture(tmp_path / "real.csv", *driving(1)),
                       capture(tmp_path / "sim.csv", *driving(2), seed=5))
    assert names(answer) == [] and answer["verdict"] in ("no gap", "cannot tell")
    assert any("gravity stays where it is" in said for said in answer["simulator"]["unseen"])


def test_what_two_logs_of_one_motion_leave_far_above_noise_is_said(tmp_path, capsys):
    """A simulator whose attitude drifts: the clock differed, and that explained all."""
    t, force, rate = turning(1, 60.0)
    drifts = np.stack([np.zeros_like(t), np.sin(0.002 * t), np.cos(0.002 * t)], 1)
    tilt = np.cumsum(0.004 * np.sin(0.5 * t))[:, None] * 0.05 * drifts
    answer = diagnosed(capsys, capture(tmp_path / "real.csv", t, force, rate),
                       capture(tmp_path / "sim.csv", t, force + np.cross(tilt, force), rate,
                               seed=5))
    gap = answer["simulator"]["gap"]["accel"]
    assert gap["after"] > 1.5 * gap["floor"]
    assert answer["verdict"] in ("unexplained", "partly explained")


@pytest.mark.parametrize("force_unit, rate_unit, found", [
    (1.0, 1.0, []), (1.0 / G, 1.0, ["accel_unit"]), (1.0, np.degrees(1.0), ["gyro_unit"])])
def test_a_unit_that_the_simulators_columns_do_not_have_is_its_fault(
        real, tmp_path, capsys, force_unit, rate_unit, found):
    t, force, rate = turning(1)
    noise = np.random.default_rng(5).normal(size=(len(t), 6)) * ([0.03] * 3 + [0.001] * 3)
    rows = np.column_stack([t, force_unit * (force + noise[:, :3]),
                            rate_unit * (rate + noise[:, 3:])])
    np.savetxt(tmp_path / "sim.csv", rows, "%.9g", ",", comments="", header=(
        "time,acc_x[m/s^2],acc_y[m/s^2],acc_z[m/s^2],gyro_x[rad/s],gyro_y[rad/s],gyro_z[rad/s]"))
    assert names(diagnosed(capsys, real, str(tmp_path / "sim.csv"))) == found


def test_gravity_of_another_strength_is_no_wrong_time_step(tmp_path, capsys):
    t, force, rate = turning(1, 60.0)
    push = 2.0 * np.abs(rate) ** 2
    answer = diagnosed(capsys, capture(tmp_path / "real.csv", t, force + push, rate),
                       capture(tmp_path / "sim.csv", t, 1.03 * force + push, rate, seed=5))
    assert "time_step" not in names(answer)


@pytest.mark.parametrize("seed", [1, 2], ids=["one motion", "another motion"])
def test_rates_that_are_divided_by_the_wrong_time_step_are_named(real, tmp_path, capsys, seed):
    """They were gravity added after the rotation, of one motion something without a name."""
    t, force, rate = turning(seed)
    answer = diagnosed(capsys, real, capture(tmp_path / "sim.csv", t, force, 0.5 * rate, seed=5))
    assert names(answer) == ["time_step"]
    step, = answer["simulator"]["conventions"]
    assert step["sensor"] == "gyro" and step["value"]["factor"] == pytest.approx(0.5, rel=0.02)


@pytest.mark.long
def test_a_delay_of_the_real_gyro_is_no_delay_of_the_simulator(tmp_path, capsys):
    """The pair of logs does not say which is late; each by itself does."""
    t, force, rate = turning(1, 80.0)
    late = np.stack([np.interp(t - 0.04, t, w) for w in rate.T], 1)
    lacks = diagnosed(capsys, capture(tmp_path / "real.csv", t, force, late),
                      capture(tmp_path / "sim.csv", t, force, rate, seed=5))
    assert names(lacks) == []
    delay = lacks["simulator"]["parameters"]["gyro"]["delay"]["all"]
    assert delay["differs"] and delay["difference"] == pytest.approx(40.0, rel=0.1)
    has = diagnosed(capsys, capture(tmp_path / "real2.csv", t, force, rate),
                    capture(tmp_path / "sim2.csv", t, force, late, seed=5))
    assert names(has) == ["gyro_delay"]


@pytest.mark.long
@pytest.mark.parametrize("mg, differs", [(0.25, False), (3.0, True)])
def test_a_bias_differs_by_more_than_it_flickers(tmp_path, capsys, mg, differs):
    """In a motion a quarter of a milligravity is certain, and at the next power-up another."""
    t, force, rate = turning(1, 300.0)
    answer = diagnosed(capsys, capture(tmp_path / "real.csv", t, force + [0, 1e-3 * mg * G, 0],
                                       rate, noise=0.3),
                       capture(tmp_path / "sim.csv", t, force, rate, noise=0.3, seed=5))
    bias = answer["simulator"]["parameters"]["accel"]["bias"]["y"]
    assert bias["differs"] == differs and bias["difference"] == pytest.approx(mg, abs=0.1)
    assert answer["verdict"] == ("explained" if differs else "no gap")


def test_biases_that_differ_together_differ_by_more_than_they_flicker():
    """None does by itself; of those that close the gap one has to be more than itself again."""
    bias = parameters.compared("bias", "gyro", "z", "°/s", 0.1, 0.02, 0.1, 0.02, least=0.003)
    less, more = (parameters.alone(bias, difference, 1e-4) for difference in (0.01, 0.02))
    assert less == bias and not less.differs
    assert more.differs and more.set_to == pytest.approx(0.12)


@pytest.mark.long
@pytest.mark.parametrize("late_s, verdict", [(0.045, "explained"), (0.0, "no gap")])
def test_a_delay_that_a_simulator_of_another_motion_lacks_is_named(tmp_path, capsys, late_s,
                                                                   verdict):
    """Two motions were compared in how late their gyros are, and what the real one has more was
    left to the diagnosis, which took it for compared."""
    t, force, rate = turning(1, 160.0)
    late = np.stack([np.interp(t - late_s, t, w) for w in rate.T], 1)
    answer = diagnosed(capsys, capture(tmp_path / "real.csv", t, force, late),
                       capture(tmp_path / "sim.csv", *turning(2, 80.0), seed=5))
    assert names(answer) == [] and answer["verdict"] == verdict
    assert [cause["effect"] for cause in answer["causes"]] == ["filter_lag"] * (late_s > 0.0)


def test_a_stamp_that_repeats_is_no_traceback(tmp_path, capsys):
    """A serial line that hands over two rows at once."""
    t, force, rate = turning(1)
    stamped = t.copy()
    stamped[700::97] = stamped[699::97][:len(stamped[700::97])]
    answer = diagnosed(capsys, capture(tmp_path / "real.csv", stamped, force, rate),
                       capture(tmp_path / "sim.csv", t, force, rate, seed=5))
    assert names(answer) == [] and answer["causes"] == []


@pytest.mark.parametrize("rows", [1, 2, 7])
@pytest.mark.parametrize("short", ["real", "sim"])
def test_a_log_of_a_few_rows_is_refused(tmp_path, capsys, rows, short):
    """A simulator's of one row had channels that never change, one of two its noise for a step."""
    paths = {name: capture(tmp_path / (name + ".csv"), *turning(seed), seed=seed)
             for seed, name in enumerate(("real", "sim"))}
    text = (tmp_path / (short + ".csv")).read_text().split("\n")
    (tmp_path / (short + ".csv")).write_text("\n".join(text[:3 + rows]) + "\n")
    assert cli.main(["diagnose", paths["real"], "--sim", paths["sim"]]) == 4
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "expected 8 and more" in said and (
        "%s.csv: it has %d row" % (short, rows) in said)

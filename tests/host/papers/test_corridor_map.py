"""reproduce --map: a small looped corridor, mapped by rbpf-slam itself, and what can go wrong."""

import dataclasses
import gzip
import json
import os

import numpy as np
import pytest

from sixflip_host import cli
from sixflip_host.errors import BadFile, CheckFailed, SixflipError
from sixflip_host.papers.corridor import (
    botlab,
    claims,
    drive,
    engine,
    experiment,
    floor_plan,
    rawlog,
    slam,
)
from tests import debian_tier

SMALL = floor_plan.Corridor(12.0, 8.0)
PLAIN, SAMPLING, GMAPPING = slam.LADDER


@pytest.fixture(scope="session")
def program():
    """rbpf-slam, unpacked into the cache where it is missing."""
    try:
        with debian_tier.alone("rbpf-slam"):
            return engine.fetch(lambda text: None)
    except SixflipError as error:
        return debian_tier.without("rbpf-slam", error)


@pytest.fixture(scope="module")
def small(program):
    """Result of one gyro in the small world, with all its maps."""
    (result,) = experiment.run(program, 1, 1000, SMALL)
    return result


def test_a_lidar_sees_the_walls_of_a_room():
    square = np.array([[[-1, -1], [1, -1]], [[1, -1], [1, 1]], [[1, 1], [-1, 1]],
                       [[-1, 1], [-1, -1]]], dtype=float)
    angles = np.radians([0.0, 45.0, 90.0, 200.0])
    origin = np.tile([0.5, 0.0], (4, 1))
    far = floor_plan.ranges(square, origin, angles, 10.0)
    assert far == pytest.approx([0.5, np.sqrt(0.5), 1.0, 1.5 / np.cos(np.radians(20.0))])
    assert np.isnan(floor_plan.ranges(square, origin, angles, 0.4)).all()
    assert floor_plan.distances(square, np.array([[0.0, 0.25], [2.0, 2.0]])) == pytest.approx(
        [0.75, np.sqrt(2.0)])


def test_the_corridor_is_as_wide_as_the_papers_and_has_doors_and_pillars():
    walls = experiment.CORRIDOR.walls()
    assert experiment.CORRIDOR.around == 130.0
    centre = floor_plan.distances(walls, np.array([[20.0, y] for y in np.linspace(-8, 8, 81)]))
    half = 0.5 * floor_plan.WIDTH_M
    assert centre.max() == pytest.approx(half)
    assert centre.min() == pytest.approx(half - floor_plan.PROTRUDES_M)
    assert len(walls) > 8 * 5


def test_the_robot_comes_round():
    route = drive.Route(SMALL)
    pose, leg, metres = route.at(np.array([0.0, route.seconds() - 1e-9]))
    assert pose[0].tolist() == [0.0, -4.0, 0.0]
    assert pose[1] == pytest.approx([drive.OVERLAP_M, -4.0, 2.0 * np.pi])
    assert metres[1] == pytest.approx(SMALL.around + drive.OVERLAP_M)
    assert leg.tolist() == [-1, 4]


@pytest.mark.long
def test_without_slam_the_path_is_the_odometry(small):
    for reading in drive.READINGS:
        path = experiment.placed(small.driven, small.maps[PLAIN.name, reading].path)
        odometry = small.driven.odometry(reading)
        assert np.abs(path[:, :2] - odometry[:, :2]).max() < 2e-3
        assert np.abs(floor_plan.wrapped(path[:, 2] - odometry[:, 2])).max() < 2e-3


@pytest.mark.long
def test_a_true_odometry_draws_the_walls_where_they_are(program, small):
    made = small.driven
    found = slam.run(program, PLAIN, made.pose, made.scans, made.t_s, reach_m=drive.REACH_M)
    quality = experiment.measured(made, found)
    assert quality.wall_m < slam.RESOLUTION_M and quality.corner_deg < 0.1
    assert quality.closure_m < 2e-3 and quality.closes


@pytest.mark.long
def test_each_reading_is_better_than_the_one_before_and_scan_matching_hides_it(small):
    off = {reading: small.quality[PLAIN.name, reading] for reading in drive.READINGS}
    assert off["raw"].corner_deg > off["rest"].corner_deg > off["Sixflip"].corner_deg
    assert off["raw"].wall_m > off["Sixflip"].wall_m
    hidden = small.quality[GMAPPING.name, "raw"]
    assert hidden.corner_deg < 0.2 * off["raw"].corner_deg
    assert hidden.closes and not off["raw"].closes


@pytest.mark.long
def test_a_seed_gives_the_same_map_twice(program, small):
    made = small.driven
    again = slam.run(program, SAMPLING, made.odometry("Sixflip"), made.scans, made.t_s,
                     reach_m=drive.REACH_M)
    assert np.array_equal(again.grid, small.maps[SAMPLING.name, "Sixflip"].grid)
    assert np.array_equal(again.path, small.maps[SAMPLING.name, "Sixflip"].path)


@pytest.mark.long
def test_the_command_prints_checks_and_keeps(program, monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(experiment, "CORRIDOR", SMALL)
    monkeypatch.setenv("SIXFLIP_DATA", str(tmp_path))
    monkeypatch.chdir(tmp_path)         # the engine runs elsewhere, a folder is named from here
    kept = tmp_path / "kept"
    words = ["reproduce", "--map", "--gyros", "1", "--keep", "kept"]
    code = cli.main(words)
    said = capsys.readouterr().out
    found = json.loads((kept / "corridor.json").read_text())
    assert code == (0 if all(one["holds"] for one in found["claims"]) else 1)
    assert len(found["corridor"]) == 9 and len(found["claims"]) == 6
    assert "scan matching hides the gyro" in " ".join(said.split())
    assert "real recording was not looked at" in said
    assert (kept / "corridor.png").read_bytes().startswith(b"\x89PNG")
    log = kept / "no_SLAM-raw" / "drive.rawlog"
    assert gzip.decompress(log.read_bytes()).startswith(b"\x91CActionCollection\x00")
    (kept / "corridor.json").unlink()
    assert cli.main(words) == 2
    assert "expected another folder" in capsys.readouterr().err


def result(corner, closure):
    """A Result of one gyro whose maps are all as good as said, {reading: number}."""
    return experiment.Result(1, {
        (step.name, reading): experiment.Quality(0.0, corner[reading], closure[reading], 0.1, 0.1)
        for step in slam.LADDER for reading in drive.READINGS})


def test_claims_hold_and_do_not():
    good = result({"raw": 40.0, "rest": 1.5, "Sixflip": 0.4},
                  {"raw": 9.0, "rest": 1.2, "Sixflip": 0.5})
    assert all(one["holds"] for one in claims.corridor(claims.rows([good]), 1))
    bad = result({"raw": 0.5, "rest": 0.5, "Sixflip": 0.9},
                 {"raw": 0.5, "rest": 0.5, "Sixflip": 1.1})
    assert not any(one["holds"] for one in claims.corridor(claims.rows([bad]), 1))


def test_the_best_scale_is_the_vertex():
    assert claims.best([(one - 1.001) ** 2 for one in claims.SCALES]) == pytest.approx(1.001)
    assert claims.best(list(range(len(claims.SCALES)))) == claims.SCALES[0]


@pytest.mark.long
def test_the_recording_is_mapped_better_without_the_bias(program, recordings):
    recording = botlab.load(recordings / botlab.RECORDING)
    half = slice(0, len(recording.scan_t) // 2)
    raw, rest = (botlab.held_out(program, recording, PLAIN, reading, part=half)
                 for reading in ("raw", "rest"))
    assert rest < claims.BOTLAB_MM < raw


def test_a_log_without_scans(tmp_path):
    with pytest.raises(BadFile, match="no scans to write, expected one with each of 3 poses"):
        rawlog.write(tmp_path / "a.rawlog", np.zeros((3, 3)), np.full((3, 8), np.nan),
                     np.arange(3.0), (0.0,) * 6)
    assert not (tmp_path / "a.rawlog").exists()


def test_a_recording_that_is_none(tmp_path):
    for name, fields in (("text", None), ("other", {"a": np.zeros(3)}),
                         ("empty", {"scan_time_us": np.zeros((0, 5))})):
        path = tmp_path / (name + ".npz")
        path.write_text("no") if fields is None else np.savez(path, **fields)
        with pytest.raises(BadFile, match="without scans" if name == "empty" else "is not the"):
            botlab.load(path)


def fake(tmp_path, text):
    """An engine that does something else."""
    program = tmp_path / "rbpf-slam"
    program.write_text("#!/bin/sh\n" + text)
    program.chmod(0o755)
    return str(program)


ONE = dict(odometry=np.zeros((2, 3)), scans=np.ones((2, 8)), t_s=np.arange(2.0))


@pytest.mark.parametrize("text, words", [
    ("echo first; echo Message: bad luck; echo '[0 ] 0x77' >&2; exit 3",
     "died with exit 3: first / Message: bad luck"),
    ("kill -SEGV $$", "died with signal 11: no word")])
def test_an_engine_that_dies_shows_its_last_lines(tmp_path, text, words):
    with pytest.raises(CheckFailed, match="rbpf-slam .no SLAM. " + words):
        slam.run(fake(tmp_path, text), PLAIN, **ONE)


def test_an_engine_that_leaves_nothing(tmp_path):
    with pytest.raises(BadFile, match="rbpf-slam left no map"):
        slam.run(fake(tmp_path, "exit 0"), PLAIN, **ONE)
    with pytest.raises(CheckFailed, match="does not start"):
        slam.run(str(tmp_path / "nowhere"), PLAIN, **ONE)


@pytest.mark.long
def test_a_log_cut_short_is_told(program, small, tmp_path, monkeypatch):
    whole = rawlog.write

    def cut(path, *words, **more):
        whole(path, *words, **more)
        data = gzip.decompress(path.read_bytes())
        path.write_bytes(gzip.compress(data[:len(data) // 2]))
    monkeypatch.setattr(rawlog, "write", cut)
    made = small.driven
    with pytest.raises(BadFile, match="its log is cut short"):
        slam.run(program, PLAIN, made.pose, made.scans, made.t_s)


def test_no_engine_is_one_line(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("SIXFLIP_CACHE", str(tmp_path / "cache"))
    assert cli.main(["reproduce", "--map"]) == 3
    said = capsys.readouterr().err
    assert "no rbpf-slam on this machine: install MRPT's" in said and said.count("\n") == 1


def test_an_engine_on_path_comes_first(tmp_path, monkeypatch):
    mine = fake(tmp_path, "")
    monkeypatch.setenv("PATH", str(tmp_path) + os.pathsep + os.environ["PATH"])
    assert engine.find() == mine


@pytest.mark.parametrize("words", [["--gyros", "3"], ["--map", "--gyros", "0"],
                                   ["--keep", "somewhere"]])
def test_wrong_words(words, capsys):
    assert cli.main(["reproduce", *words]) == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.long
def test_qualities_are_values(small):
    with pytest.raises(dataclasses.FrozenInstanceError):
        small.quality[PLAIN.name, "raw"].wall_m = 0.0

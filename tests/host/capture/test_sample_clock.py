"""The clock of a recording: its rate, and losses, pauses, bursts and jitter told apart; rows and
losses are always what was expected."""

from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.capture import capture_file, clock, clock_words, stamp_envelope
from sixflip_host.diagnosis.detect import sample_clock

ROWS, PERIOD = 6000, 10050.0    # µs: 99.5025 Hz
EVEN = np.arange(ROWS) * PERIOD


def measured(t_us):
    found = clock.measure(np.rint(t_us).astype(np.int64))
    assert found.rows + found.losses == found.expected
    running = (t_us[-1] - t_us[0]) / 1e6 - found.pause_s
    assert (found.expected - 1) / running == pytest.approx(found.rate_hz, rel=1e-6)
    return found


def near(found, rate=1e6 / PERIOD):
    low, high = found.interval_hz
    slack = 2e-6 * rate      # of stamps in whole µs
    assert low - slack <= rate <= high + slack and high - low < 0.02 * rate


def test_an_even_clock_has_a_rate_and_nothing_else():
    found = measured(EVEN)
    near(found)
    assert (found.losses, found.pauses, found.late) == (0, 0, 0) and found.jitter_ms < 0.01


def test_stamps_of_whole_milliseconds_do_not_bend_the_rate():
    found = measured(np.floor(np.arange(ROWS) * 2.5) * 1000)
    near(found, 400.0)
    assert found.losses == found.late == 0


def test_pauses_are_no_losses():
    t = EVEN.copy()
    t[1000:] += 3_003_217
    t[4000:] += 1_700_499
    found = measured(t)
    near(found)
    assert (found.pauses, found.losses) == (2, 0)
    assert found.pause_s == pytest.approx(4.7037, abs=0.01)


@pytest.mark.parametrize("rows", [1, 2, 5])
def test_stamps_that_were_not_renewed_are_no_losses(rows):
    """Rows that have the stamp of one before were each a loss, and the rate was off by as many."""
    t, generator = EVEN.copy(), np.random.default_rng(2)
    for first in generator.choice(np.arange(10, ROWS - 10, 10), 60, replace=False):
        t[first:first + rows] = EVEN[first - 1]
    found = measured(t)
    near(found)
    assert (found.losses, found.late, found.pauses) == (0, 0, 0)
    queued = EVEN.copy()  # the one after such a stamp is that of the row that had none
    queued[1000:1002] = EVEN[999:1001]
    assert (measured(queued).losses, measured(queued).late) == (0, 0)


@pytest.mark.parametrize("rows", [2, 4, 8])
@pytest.mark.parametrize("first", [0, 1, 3])
def test_rows_that_are_handed_over_together_are_late_wherever_a_recording_begins(rows, first):
    t = (np.arange(first, first + ROWS) // rows + 1) * rows * PERIOD
    t = t + np.random.default_rng(4).uniform(0.0, 500.0, ROWS // rows + 2)[
        np.arange(first, first + ROWS) // rows]
    found = measured(t)
    assert found.late > 0.4 * ROWS and found.losses <= rows


def test_a_loss_beside_stamps_that_were_not_renewed_is_one():
    t = EVEN.copy()
    t[2000:] += 3 * PERIOD
    t[3000] = t[2999]
    found = measured(t)
    near(found)
    assert (found.losses, found.loss_gaps) == (3, 1)


def test_short_pauses_after_which_the_clock_begins_anew_are_no_losses():
    t, generator = EVEN.copy(), np.random.default_rng(1)
    for row in range(200, ROWS, 200):
        t[row:] += generator.uniform(20e3, 45e3)
    found = measured(t)
    near(found)
    assert (found.pauses, found.losses) == (29, 0)


@pytest.mark.parametrize("whole", [False, True])
def test_a_loop_that_sleeps_pauses_and_one_that_misses_rows_loses_them(whole):
    """Its stamps scatter by a tenth of a period about an even clock, more than was taken to tell
    a phase by: each of its pauses was counted as rows that are lost."""
    generator = np.random.default_rng(3)
    periods = 0.96 + 0.04 * generator.gamma(3.0, 1.0, ROWS) / 3.0
    stands = generator.choice(ROWS, 30, replace=False)
    periods[stands] += generator.integers(1, 4, 30) if whole else generator.uniform(0.6, 3.4, 30)
    found = measured(PERIOD * np.cumsum(periods))
    assert (found.losses > 40) == whole and (found.pauses > 20) != whole


@pytest.mark.parametrize("lost, said", [(0, False), (10, True)])
def test_a_few_rows_that_are_lost_show_in_stamps_that_scatter(lost, said):
    """A gap begins with a row as late as any, and the clock goes by the earliest ones: it is less
    than a whole number by as much as the stamps scatter."""
    generator = np.random.default_rng(4)
    keep = np.ones(30000, bool)
    keep[generator.choice(29000, lost, replace=False) + 500] = False
    t = PERIOD * (np.arange(30000) + 0.05 * generator.normal(size=30000))[keep]
    found = measured(t)
    assert found.losses == lost and bool(sample_clock.drops([found])) == said


@pytest.mark.parametrize("hz", [700.0, 952.0, 1000.0, 1200.0])
def test_whole_milliseconds_of_a_fast_clock_are_no_losses(hz):
    """Their usual interval is the step of the stamps, and each of the others was a lost row."""
    found = clock.measure(np.floor(np.arange(30000) * 1e3 / hz).astype(np.int64) * 1000)
    assert found.losses == 0 and found.rate_hz == pytest.approx(hz, rel=1e-4)


def test_pauses_of_less_than_a_sample_do_not_bend_the_rate():
    """A recorder that waits for its next look after every delay; with its small ones
    left out the rate was a thousandth too low and more."""
    generator = np.random.default_rng(3)
    waits = np.where(generator.random(ROWS) < 0.03, generator.uniform(0.3, 3.5, ROWS), 0.0)
    found = measured(EVEN + np.cumsum(waits) * PERIOD + generator.integers(-60, 61, ROWS))
    assert found.rate_hz == pytest.approx(1e6 / PERIOD, rel=6e-4)
    assert (found.losses, found.late) == (0, 0) and found.pauses > 0.9 * (waits > 0).sum()


def test_a_stamp_that_scatters_is_not_late_because_the_recorder_paused():
    generator = np.random.default_rng(4)
    t = EVEN + np.cumsum(np.arange(ROWS) % 1000 == 500) * 1.43 * PERIOD
    t += np.cumsum(np.arange(ROWS) % 2000 == 700) * 2.31 * PERIOD
    found = measured(t + generator.exponential(300.0, ROWS))
    assert (found.late, found.bursts, found.losses) == (0, 0, 0) and found.pauses >= 9


@pytest.mark.parametrize("lost", [
    np.random.default_rng(2).random(ROWS) < 0.05, np.random.default_rng(2).random(ROWS) < 0.2,
    np.isin(np.arange(ROWS) // 20, np.arange(20, 300, 25))])
def test_losses_are_counted_and_do_not_bend_the_rate(lost):
    lost[[0, -1]] = False
    found = measured(EVEN[~lost])
    near(found)
    assert (found.losses, found.pauses, found.expected) == (lost.sum(), 0, ROWS)


def test_losses_under_stamps_that_scatter_do_not_bend_the_rate():
    """A twelfth of a period to both sides, and one row in 25 lost: half of the losses were found,
    and the others made the period two per cent longer."""
    generator = np.random.default_rng(7)
    lost = generator.random(ROWS) < 0.04
    lost[[0, -1]] = False
    found = measured((EVEN + 0.083 * PERIOD * generator.standard_normal(ROWS))[~lost])
    near(found)
    assert found.losses == pytest.approx(lost.sum(), abs=3) and found.pauses == 0
    assert sample_clock.drops([found])


def test_rows_that_come_in_bursts_are_late_and_not_lost():
    row = np.arange(ROWS)
    t = EVEN[np.minimum(row // 8 * 8 + 7, ROWS - 1)] + row % 8 * 50
    found = measured(t)
    near(found)
    assert (found.losses, found.pauses, found.bursts) == (0, 0, ROWS // 8)
    assert found.longest_late_ms == pytest.approx(70, abs=1)
    for first in range(500, ROWS, 700):
        t[first:] += 24 * PERIOD
    found = measured(t)
    assert found.losses == pytest.approx(24 * 8, abs=8)


def test_jitter_is_none_of_the_three():
    generator = np.random.default_rng(3)
    found = measured(EVEN + generator.normal(0, 1000, ROWS).clip(-4000, 4000))
    near(found)
    assert (found.losses, found.pauses, found.late) == (0, 0, 0)
    assert found.jitter_ms == pytest.approx(1.0, abs=0.2)


def test_times_that_do_not_run_have_no_clock():
    assert clock.measure(np.zeros(50, np.int64)) is None
    assert clock.measure(np.array([5])) is None


def capture(t_us, **meta):
    counts = np.random.default_rng(4).normal((0, 0, 16384), 40, (len(t_us), 3))
    return capture_file.Capture(
        {"sensor": "mpu6050", "rate_hz": 100, "accel_lsb_per_g": 16384, **meta},
        np.rint(t_us).astype(np.int64), np.rint(counts).astype(np.int16))


def test_the_writes_that_a_boards_own_file_names_are_pauses_of_its_recorder():
    t = EVEN.copy()
    t[3000:] += 3 * PERIOD
    assert clock.sample_clock(capture(t)).losses == 3
    written = {"write_pauses_us": [int(np.rint(t[2999]))]}
    found = clock.sample_clock(capture(t, board_capture=written))
    assert (found.losses, found.pauses) == (0, 1)
    found = clock.sample_clock(capture(t, board_capture={"write_pauses_us": []}))
    assert (found.losses, found.pauses) == (3, 0)


def test_whether_the_rate_was_measured_stands_in_the_header(tmp_path):
    assert clock.is_measured({"rate": "measured"}) and not clock.is_measured({"rate": "stated"})
    assert not clock.is_measured({}) and clock.is_measured({"imported_from": "old.csv"})
    path = tmp_path / "a.csv"
    capture_file.write(path, capture(EVEN, rate="measured", rate_interval_hz=[99.4, 99.6]))
    assert capture_file.read(path).meta["rate"] == "measured"
    path.write_text(path.read_text().replace('"measured"', '"guessed"'))
    with pytest.raises(capture_file.BadFile, match='rate is ""guessed"", expected stated or'):
        capture_file.read(path)


def judged(*captures):
    """{effect: Finding} of a diagnosis' look at the clocks, and its remarks."""
    sessions = [SimpleNamespace(name="c%d.csv" % k, capture=one, rate=one.meta["rate_hz"],
                                timeless=False) for k, one in enumerate(captures)]
    clocks = sample_clock.clocks(sessions)
    assert all(one["expected"] == one["rows"] + one["losses"]["samples"]
               for one in sample_clock.answer(sessions, clocks))
    return ({one.effect: one for one in sample_clock.findings(sessions)},
            " ".join(sample_clock.remarks(sessions, clocks)))


def test_a_rate_that_is_stated_is_judged_and_a_measured_one_is_not():
    found, _ = judged(capture(EVEN, rate_hz=98))
    assert set(found) == {"sample_rate"} and "99.50 Hz, not 98" in found["sample_rate"].words
    assert judged(capture(EVEN, rate_hz=98, rate="measured"))[0] == {}
    assert judged(capture(EVEN, rate_hz=99.5, rate="stated"))[0] == {}


def test_a_clock_that_is_off_is_one_clock_in_all_sessions():
    """Three sessions say no more often than one that 0.14 % is not what was stated."""
    def three(off):
        return judged(*[capture(EVEN + k, rate_hz=99.5 * (1.0 + off)) for k in range(3)])[0]
    assert three(0.0014) == {} and set(three(0.003)) == {"sample_rate"}


def test_a_healthy_pull_with_writes_to_the_flash_loses_nothing():
    t, generator = EVEN.copy(), np.random.default_rng(6)
    for row in range(128, ROWS, 128):
        t[row:] += generator.uniform(20e3, 45e3)
    found, said = judged(capture(t, board_capture={"write_pauses_us": []}, rate_hz=99.5))
    assert found == {} and "wrote to its flash 46 times" in said


def test_pauses_and_bursts_of_a_foreign_log_are_said_and_are_no_cause():
    t = EVEN[np.minimum(np.arange(ROWS) // 8 * 8 + 7, ROWS - 1)] + np.arange(ROWS) % 8 * 50
    t[3000:] += 2_504_000
    found, said = judged(capture(t, rate="measured"))
    assert found == {} and "pauses: the recorder stood still 1 time" in said and "bursts:" in said


def test_samples_lost_under_a_steady_clock_are_the_devices():
    lost = np.isin(np.arange(ROWS) // 20, np.arange(20, 300, 25))
    found, _ = judged(capture(EVEN[~lost], rate="measured"))
    assert found["dropped_samples"].value["chance"] == pytest.approx(4.0, abs=0.01)


def test_a_recorder_that_hurries_after_a_late_row_loses_nothing():
    """A loop of 3 ms that a write holds up for 10 ms every 70 rows, and that then reads every
    2.4 ms until it is back in its pace; stamps in whole milliseconds."""
    t, now = np.zeros(ROWS), 0.0
    for row in range(ROWS):
        due = row * 3000.0
        now = max(due, now + 2400.0) + (9500.0 if row % 70 == 69 else 0.0)
        t[row] = now
    found = measured(np.floor(t / 1000) * 1000)
    near(found, 1e6 / 3000)
    assert (found.losses, found.pauses) == (0, 0) and found.bursts >= ROWS // 70


def test_a_pause_of_seconds_in_a_slow_log_is_no_loss():
    t = np.arange(3000) * 100000
    t[1500:] += 1700000
    found = clock.measure(t)
    assert (found.losses, found.pauses) == (0, 1)


def held_by_a_link(later_late):
    """Stamps of 500 rows that came every 2.6 ms, then of rows in time but for some that are late
    by 20 ms (later_late) and caught up at that pace."""
    t, n = EVEN.copy(), 500
    t[:n] = t[n] - 2600.0 * (n - np.arange(n))
    if later_late:
        for first in range(700, ROWS - 10, 40):
            caught_up = EVEN[first] + 20_000.0 + 2600.0 * np.arange(3)
            t[first:first + 3] = np.maximum(EVEN[first:first + 3], caught_up)
    return np.rint(t - t[0]).astype(np.int64)


def test_rows_that_a_link_still_held_at_the_start_came_late():
    """They made the rate 6 % higher, and the first of them was late by what 64 rows are."""
    found = clock.measure(held_by_a_link(True))
    near(found)
    assert found.rate_hz == pytest.approx(1e6 / PERIOD, rel=1e-4)
    assert (found.rows, found.losses, found.pauses) == (ROWS, 0, 0) and found.late >= 500
    assert found.longest_late_ms == pytest.approx(500 * (PERIOD - 2600.0) / 1e3, rel=1e-3)


def test_rows_that_share_the_stamps_of_a_coarse_clock_are_not_late():
    """Whole seconds at 100 rows a second: 99 rows came 990 ms late."""
    t_us = (np.floor(np.arange(20000) / 100.0) * 1e6).astype(np.int64)
    assert clock.measure(t_us).late == 0


def test_a_sensor_that_was_faster_at_first_held_nothing():
    assert stamp_envelope.backlog(held_by_a_link(False)) == 0
    assert stamp_envelope.backlog(held_by_a_link(True)) == 500


def test_rows_that_are_lost_on_the_way_are_told_though_the_recorder_paused_for_long():
    """A third of them, from a wrist, and ten minutes in which nobody wore it: the mean interval is
    that of the pause, and the stamps are no bursts'."""
    generator = np.random.default_rng(21)
    t = 107_000.0 * np.flatnonzero(generator.random(18000) > 0.35)
    t = np.rint(t / 1000.0 + generator.normal(0.0, 3.0, len(t))) * 1000.0
    t[4000:] += 826e6
    t[9000:] += 2e6
    lost = 18000 - len(t)
    found = measured(np.maximum.accumulate(t))
    near(found, 1e6 / 107_000.0)
    assert found.losses == pytest.approx(lost, rel=0.01) and found.late < 0.01 * ROWS


def test_rows_that_are_lost_are_told_beside_stamps_that_were_not_renewed():
    """A phone gave every third row the stamp and the values of the one before, which is left out,
    and at times its stamp alone: a tenth of the intervals last nothing."""
    generator = np.random.default_rng(22)
    rows = np.arange(3000)
    t = np.rint(195.5 * rows + generator.normal(0.0, 4.0, len(rows))) * 1000.0
    stale = rows % 3 == 2
    t[stale] = t[np.flatnonzero(stale) - 1]
    kept = ~stale | (generator.random(len(rows)) < 0.28)
    found = measured(t[kept])
    assert found.rate_hz == pytest.approx(1e6 / 195_500.0, rel=0.003)
    assert found.losses == pytest.approx((~kept).sum(), rel=0.03)
    assert found.late < 0.05 * kept.sum()


def test_what_pauses_every_second_had_no_rows_ready_when_it_began():
    """As fast at first as ever: nothing came late."""
    t = np.cumsum(np.random.default_rng(23).normal(2541.0, 8.0, 3960))
    t += (np.arange(3960) // 360 + 0.01 * (np.arange(3960) > 359)) * 1.65e6
    found = measured(t)
    near(found, 1e6 / 2541.0)
    assert (found.late, found.pauses) == (0, 10)


def test_a_rate_that_changes_on_the_way_makes_no_row_late():
    generator = np.random.default_rng(24)
    t = np.cumsum(np.repeat([41_400.0, 49_000.0], [330, 290]))
    t = np.rint((t + generator.normal(0.0, 1000.0, len(t))) / 1000.0) * 1000.0
    found = measured(t)
    assert (found.late, found.losses) == (0, 0)
    (first, quick), (row, slow) = found.paces
    assert first == 0 and abs(row - 330) < 15
    assert (quick, slow) == pytest.approx((1e6 / 41_400, 1e6 / 49_000), rel=0.01)
    assert "the rate changed on the way: 24." in " ".join(clock_words.words(found))

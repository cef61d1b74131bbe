"""The times of an imported table: told by name and value, put in order, or asked for."""

import datetime

import numpy as np
import pytest

from sixflip_host.capture import clock as sixflip_clock
from sixflip_host.capture import clock_words
from tests.worlds.imported_text import (
    COUNTS,
    ROWS,
    SECONDS,
    imported,
    lines,
    refused,
    table,
)


def test_matlabs_writetable_has_the_months_name_in_its_times(tmp_path, capsys):
    texts = [table(["31-%s-2024 12:00:%06.3f" % (month, t) for t in SECONDS], "Timestamp")
             for month in ("Feb", "May")]
    assert "31-Feb-2024" in refused(tmp_path, capsys, texts[0], "--accel-lsb", "16384")
    capture, _ = imported(tmp_path, capsys, texts[1], "--accel-lsb", "16384")
    assert capture.t_us[-1] - capture.t_us[0] == pytest.approx(3_990_000, abs=1)


@pytest.mark.parametrize("head, times", [
    ("t", ["%.3f" % t for t in SECONDS]), ("time", ["%d" % round(1e3 * t) for t in SECONDS]),
    ("timestamp", ["%d" % round(1e6 * t) for t in SECONDS]),
    ("%time", ["%d" % (1.6e18 + 1e9 * t) for t in SECONDS]),
    ("timestamp_ms", ["%d" % round(1e3 * t) for t in SECONDS]),
    ("header.stamp", ["%.2f" % (1.6e9 + t) for t in SECONDS]),
    ("Time (s)", ["%.4e" % t for t in SECONDS]),
    ("ustime", ["%d" % round(2.3e9 + 1e6 * t) for t in SECONDS]),
    ("timems", ["%d" % round(1e3 * t) for t in SECONDS]),
    ("micros", ["%d" % round(1e6 * t) for t in SECONDS])])
def test_times_by_name_and_value(tmp_path, capsys, head, times):
    capture, said = imported(tmp_path, capsys, table(times, head))
    assert capture.meta["rate_hz"] == pytest.approx(100, rel=1e-3)
    assert capture.meta["rate"] == "measured" and "times are in the column " + head in said
    assert np.abs(np.diff(capture.t_us) - 10000).max() < 2


def test_times_that_two_units_would_do_for_are_asked_for(tmp_path, capsys):
    said = refused(tmp_path, capsys, table([200 * k for k in range(ROWS)]))
    assert "expected --time-unit with one of us (5000 Hz, 0.0798 s), ms (5 Hz, 79.8 s)" in said
    said = refused(tmp_path, capsys, table(range(ROWS)))
    assert "t counts by 1, which may be samples" in said


def test_the_rate_that_was_set_is_stated_and_not_measured(tmp_path, capsys):
    capture, _ = imported(tmp_path, capsys, table(["%.3f" % t for t in SECONDS]), "--rate", "99",
                          "--time-unit", "s")
    assert (capture.meta["rate_hz"], capture.meta["rate"]) == (99, "stated")


def test_a_rate_that_stands_before_the_names(tmp_path, capsys):
    text = "Fs,104\nMode,2\nax,ay,az\n" + "\n".join(lines(COUNTS)) + "\n"
    capture, said = imported(tmp_path, capsys, text)
    assert (capture.meta["rate_hz"], capture.meta["rate"]) == (104, "stated")
    assert "104 Hz, as the file says" in said


def test_sort_says_what_it_moved(tmp_path, capsys):
    times = ["%.2f" % t for t in SECONDS]
    times[50], times[53] = times[53], times[50]
    assert "line 53: t runs backwards" in refused(tmp_path, capsys, table(times))
    _, said = imported(tmp_path, capsys, table(times), "--sort")
    assert "3 rows moved to put t in order, the farthest by 3 rows" in said


@pytest.mark.parametrize("row", [0, 200, ROWS - 1])
def test_a_stamp_that_stretches_the_log_is_refused(tmp_path, capsys, row):
    times = ["%.2f" % t for t in SECONDS]
    times[row] = "86400.00" if row else "-86400.00"
    said = refused(tmp_path, capsys, table(times), "--sort", "--time-unit", "s")
    assert "in.csv line %d: t is" % (row + 2) in said and "which stretches 3.9" in said


def clock(t, form):
    """The time t seconds behind 23:59:58.5 on the last of February, in a form."""
    day = datetime.datetime(2024, 2, 29, 23, 59, 58, 500000) + datetime.timedelta(seconds=t)
    return day.strftime(form)


@pytest.mark.parametrize("head, form", [
    ("timestamp", "%Y-%m-%dT%H:%M:%S.%f"), ("time", "%Y-%m-%d %H:%M:%S.%fZ"),
    ("datetime", "%Y-%m-%dT%H:%M:%S.%f+05:30"), ("timestamp", '"%Y-%m-%d %H:%M:%S,%f"')])
def test_dates_and_times_of_day_are_times(tmp_path, capsys, head, form):
    capture, said = imported(tmp_path, capsys, table([clock(t, form) for t in SECONDS], head))
    assert "dates and times of day in the column %s" % head in said
    assert capture.meta["rate_hz"] == pytest.approx(100.0, rel=1e-6)
    assert capture.t_us[-1] == 10_000 * (ROWS - 1)


def test_times_of_day_alone_and_a_date_beside_them(tmp_path, capsys):
    times = ["2024-05-31,%s" % clock(t - 9e3, "%H:%M:%S.%f") for t in SECONDS]
    capture, _ = imported(tmp_path, capsys, table(times, "date,time"))
    assert capture.t_us[-1] == 10_000 * (ROWS - 1)


@pytest.mark.parametrize("times, line", [
    (["05/06/2024 10:00:0%d.%d" % divmod(k, 10) for k in range(50)], "day and month"),
    (["2024-02-30T10:00:0%d.%d" % divmod(k, 10) for k in range(50)], "expected a number")])
def test_dates_that_say_nothing_sure_are_refused(tmp_path, capsys, times, line):
    assert line in refused(tmp_path, capsys, table(times, "t"), "--time-column", "t")


def test_a_time_that_is_none_is_refused_with_what_was_expected(tmp_path, capsys):
    rows = ["12h%03d,%s" % (k, one) for k, one in enumerate(lines(COUNTS))]
    said = refused(tmp_path, capsys, "time,ax,ay,az\n" + "\n".join(rows) + "\n")
    assert "the column time begins with \"12h000\", expected a number or ISO 8601" in said


@pytest.mark.parametrize("name,size,step", [
    ("micros", 2 ** 32, 10_000), ("millis", 2 ** 32, 10), ("t_ms", 2 ** 16, 10),
    ("utc_ns", 10 ** 9, 10_000_000)])
@pytest.mark.parametrize("sort", [(), ("--sort",)])
def test_a_clock_that_begins_anew_goes_on(tmp_path, capsys, name, size, step, sort):
    rows = ["%d,%s" % ((size + (k - 150) * step) % size, one)
            for k, one in enumerate(lines(COUNTS))]
    capture, said = imported(tmp_path, capsys, name + ",ax,ay,az\n" + "\n".join(rows) + "\n",
                             *sort)
    assert (np.diff(capture.t_us) == 10_000).all() and (capture.accel == COUNTS).all()
    assert "%s begins anew at %.10g, first in line" % (name, size) in said


def test_a_counter_with_a_sign_begins_anew_below_0(tmp_path, capsys):
    rows = ["%d,%s" % ((2 ** 31 + (k - 150) * 10_000 + 2 ** 31) % 2 ** 32 - 2 ** 31, one)
            for k, one in enumerate(lines(COUNTS))]
    capture, _ = imported(tmp_path, capsys, "micros,ax,ay,az\n" + "\n".join(rows) + "\n")
    assert (np.diff(capture.t_us) == 10_000).all()


@pytest.mark.parametrize("name,seconds", [("time (min)", 60.0), ("time_h", 3600.0)])
def test_minutes_and_hours_by_their_name(tmp_path, capsys, name, seconds):
    rows = ["%.9f,%s" % (0.01 * k / seconds, one) for k, one in enumerate(lines(COUNTS))]
    capture, _ = imported(tmp_path, capsys, name + ",ax,ay,az\n" + "\n".join(rows) + "\n")
    assert capture.meta["rate_hz"] == pytest.approx(100.0, rel=1e-3)


def test_a_log_goes_on_over_midnight(tmp_path, capsys):
    day = ["%02d:%02d:%05.2f" % (23 if k < 200 else 0, 59 if k < 200 else 0,
                                 58.0 + k / 100 if k < 200 else k / 100 - 2.0)
           for k in range(ROWS)]
    capture, _ = imported(tmp_path, capsys, "time,ax,ay,az\n" + "\n".join(
        "%s,%s" % pair for pair in zip(day, lines(COUNTS))) + "\n")
    assert np.diff(capture.t_us) == pytest.approx(10_000, abs=1)


def test_a_board_that_began_again_is_no_clock_that_does(tmp_path, capsys):
    rows = ["%d,%s" % (10 * (k % 200) + 5000, one) for k, one in enumerate(lines(COUNTS))]
    said = refused(tmp_path, capsys, "t_ms,ax,ay,az\n" + "\n".join(rows) + "\n")
    assert "line 202: t_ms runs backwards, from 6990 to 5000" in said


def test_times_that_fit_the_stated_rate_in_no_unit_are_refused(tmp_path, capsys):
    """Ticks of 100 µs are a tenth of that rate in ms."""
    rows = ["%d,%s" % (100 * k, one) for k, one in enumerate(lines(COUNTS))]
    text = "// Update Rate: 100.0Hz\nclock,Acc_X,Acc_Y,Acc_Z\n" + "\n".join(rows) + "\n"
    said = refused(tmp_path, capsys, text)
    assert "clock taken as ms: 10 Hz, but the file says 100 Hz" in said
    capture, _ = imported(tmp_path, capsys, text, "--rate", "100")
    assert capture.meta["rate_hz"] == 100.0


@pytest.mark.parametrize("step, rate, unit, other", [
    (25, 400.0, "100us", ""),                           # of MT Manager
    (16667, 60.0, "us", "100us (0.6 Hz")])              # of Xsens DOT
def test_what_a_maker_counts_under_a_name_is_all_that_its_unit_may_be(tmp_path, capsys, step,
                                                                      rate, unit, other):
    """Of 25 ms 400 rows would be ten seconds at 40 Hz, which an IMU's log may be as well."""
    rows = ["%d\t%s" % (step * k, one.replace(",", "\t")) for k, one in enumerate(lines(COUNTS))]
    text = "\t".join(["SampleTimeFine", "Acc_X", "Acc_Y", "Acc_Z"]) + "\n" + "\n".join(rows) + "\n"
    capture, said = imported(tmp_path, capsys, text)
    assert capture.meta["rate_hz"] == pytest.approx(rate, rel=1e-3)
    assert "SampleTimeFine taken as %s: %.4g Hz" % (unit, rate) in said and other in said
    named, _ = imported(tmp_path, capsys, text, "--time-unit", "us" if other else "100us")
    assert (named.t_us == capture.t_us).all()


@pytest.mark.parametrize("name, scale", [
    ("device_timestamp_ms", 1e3), ("uptime (ms)", 1e3), ("age in microseconds", 1e6),
    ("counter_ns", 1e9), ("when_s", 1.0)])
def test_the_unit_in_the_name_of_the_column_that_was_said(tmp_path, capsys, name, scale):
    """A row a second or so: its number alone would be a plausible one of another unit."""
    times = ["%.0f" % (scale * 0.9 * k + 40 * scale) if scale > 1 else "%.1f" % (0.9 * k)
             for k in range(ROWS)]
    capture, _ = imported(tmp_path, capsys, table(times, name), "--time-column", name)
    assert capture.meta["rate_hz"] == pytest.approx(1 / 0.9, rel=1e-3)


@pytest.mark.parametrize("head", ["server_time", "host_timestamp", "rx_time", "received_at_time"])
def test_the_devices_own_clock_is_better_than_when_its_rows_came(tmp_path, capsys, head):
    late = np.random.default_rng(15).exponential(0.1, ROWS)
    times = ["%s,%.0f" % (clock(t + more, "%Y-%m-%dT%H:%M:%S.%f"), 1e3 * t) for t, more in zip(
        SECONDS, np.maximum.accumulate(SECONDS + late) - SECONDS)]
    capture, said = imported(tmp_path, capsys, table(times, head + ",device_timestamp_ms"))
    assert "times are in the column device_timestamp_ms" in said
    assert (np.diff(capture.t_us) == 10_000).all()


def test_the_sensors_own_time_is_better_than_the_systems(tmp_path, capsys):
    """Rows of an app come as late as it has something else to do."""
    late = np.maximum.accumulate(SECONDS + np.random.default_rng(25).exponential(0.008, ROWS))
    times = ["%.3f,%.3f" % each for each in zip(late, SECONDS)]
    capture, said = imported(tmp_path, capsys, table(
        times, "elapsed-time-system,elapsed-time-sensor"))
    assert "times are in the column elapsed-time-sensor" in said
    assert (np.diff(capture.t_us) == 10_000).all()


def test_nanoseconds_are_the_sensors_own_beside_milliseconds(tmp_path, capsys):
    """A phone stamps its readings by the one, and its app writes the other when they come."""
    late = np.maximum.accumulate(SECONDS + np.random.default_rng(26).exponential(0.02, ROWS))
    times = ["%.0f,%.0f" % (1e3 * came, 1e9 * t) for came, t in zip(late, SECONDS)]
    capture, said = imported(tmp_path, capsys, table(times, "timeMillis,timeNanos"))
    assert "times are in the column timeNanos" in said
    assert (np.diff(capture.t_us) == 10_000).all()


def test_a_finer_clock_is_better_than_whole_seconds(tmp_path, capsys):
    times = ["%s,%.0f" % (clock(t, "%Y-%m-%d %H:%M:%S"), 1e3 * t) for t in SECONDS]
    capture, said = imported(tmp_path, capsys, table(times, "Timestamp,Milliseconds"))
    assert "times are in the column Milliseconds" in said
    assert (np.diff(capture.t_us) == 10_000).all()


@pytest.mark.parametrize("seconds", [0.5, 0.25])
def test_a_log_of_a_few_rows_a_second_is_no_fast_one_of_a_moment(tmp_path, capsys, seconds):
    times = seconds * (np.arange(ROWS) + np.random.default_rng(16).uniform(-0.05, 0.05, ROWS))
    capture, said = imported(tmp_path, capsys, table(["%.17g" % t for t in times], "Time"))
    assert capture.meta["rate_hz"] == pytest.approx(1 / seconds, rel=0.01)
    assert "Time taken as s: " in said
    assert " s; --time-unit if it is ms (" in said and " Hz, 0." in said
    capture, said = imported(tmp_path, capsys, table(["%.17g" % t for t in times], "Time"),
                             "--time-unit", "ms")
    assert capture.meta["rate_hz"] == pytest.approx(1000 / seconds, rel=0.01)
    assert "taken as" not in said


def test_rows_that_share_whole_seconds_are_spread_evenly(tmp_path, capsys):
    """31 Hz from somewhere within a second, to somewhere within one."""
    times = [clock(k / 31 + 0.3, "%Y-%m-%d %H:%M:%S") for k in range(ROWS)]
    capture, said = imported(tmp_path, capsys, table(times, "Timestamp"))
    assert "Timestamp goes on in steps of 1 s, which 31 rows share: they are spread" in said
    assert "bursts:" not in said and "jitter:" not in said
    assert capture.meta["rate_hz"] == pytest.approx(31, rel=1 / ROWS)
    low, high = capture.meta["rate_interval_hz"]
    assert low < 31 < high and high - low > 31 / ROWS
    assert np.abs(capture.t_us - np.arange(ROWS) * 1e6 / 31).max() < 40_000


def test_rows_that_were_spread_say_nothing_of_how_the_stamps_scatter(tmp_path, capsys):
    """Of a clock that wanders by a row or two, so that 48 or 49 rows have the same second."""
    k = np.arange(1500)
    seconds = k / 48.5 + 0.3 + 0.03 * np.sin(2 * np.pi * k / 400)
    text = table([clock(t, "%Y-%m-%d %H:%M:%S") for t in seconds], "Timestamp",
                 np.random.default_rng(21).normal([0, 0, 16384], 40, (len(k), 3)))
    capture, said = imported(tmp_path, capsys, text)
    assert "which 48 rows share" in said or "which 49 rows share" in said
    measured = sixflip_clock.sample_clock(capture)
    assert measured.resolution_ms == 1000.0 and measured.jitter_ms > 0.01 * 1e3 / 48.5
    assert "jitter:" not in said and not any("jitter:" in line
                                             for line in clock_words.words(measured))


def test_rows_that_share_seconds_of_a_recorder_that_stood_still(tmp_path, capsys):
    """Rows after a pause of 7 s are no row a quarter of a second."""
    seconds = np.arange(ROWS) / 31 + 0.3 + 7.0 * (np.arange(ROWS) >= 200)
    times = [clock(t, "%Y-%m-%d %H:%M:%S") for t in seconds]
    capture, said = imported(tmp_path, capsys, table(times, "Timestamp"))
    assert "pauses: the recorder stood still 1 time" in said and "bursts:" not in said
    assert np.abs(capture.t_us - 1e6 * (seconds - seconds[0])).max() < 1.1e6
    assert capture.meta["rate_hz"] == pytest.approx(31, rel=0.03)


def test_rows_that_a_link_hands_over_together_keep_their_stamps(tmp_path, capsys):
    arrived = np.cumsum(80_000 + np.random.default_rng(18).integers(-3000, 3000, ROWS // 8))
    capture, said = imported(tmp_path, capsys, table(np.repeat(arrived, 8), "t_us"))
    assert "spread" not in said
    assert (capture.t_us == np.repeat(arrived - arrived[0], 8)).all()


@pytest.mark.parametrize("head, step, unit", [
    ("time_us", 10, "ms (100 Hz)"), ("micros", 1, "ms (1000 Hz)"), ("t_ns", 5, "ms (200 Hz)")])
def test_a_unit_by_name_that_no_log_is_as_fast_in_is_refused(tmp_path, capsys, head, step, unit):
    """Milliseconds in a column time_us were a log of 100000 Hz."""
    text = table([step * k for k in range(ROWS)], head)
    said = refused(tmp_path, capsys, text)
    assert "expected less than 8000 Hz: --time-unit " + unit in said
    capture, _ = imported(tmp_path, capsys, text, "--time-unit", "ms")
    assert capture.meta["rate_hz"] == pytest.approx(1e3 / step, rel=1e-3)
    capture, _ = imported(tmp_path, capsys, table([step * k for k in range(ROWS)], "t_ms"))
    assert capture.meta["rate_hz"] == pytest.approx(1e3 / step, rel=1e-3)


def test_a_unit_by_name_that_a_log_is_slow_in_is_said(tmp_path, capsys):
    capture, said = imported(tmp_path, capsys, table([10 * k for k in range(ROWS)], "time_s"))
    assert capture.meta["rate_hz"] == pytest.approx(0.1, rel=1e-3)
    assert "as its name says: 0.1 Hz; --time-unit if it is ms (100 Hz)" in said


def test_a_moment_in_milliseconds_with_decimals_is_asked_for(tmp_path, capsys):
    """400 rows at 1 kHz were as many seconds."""
    times = ["%.3f" % t for t in np.arange(ROWS) + np.random.default_rng(3).uniform(0, 0.01, ROWS)]
    said = refused(tmp_path, capsys, table(times))
    assert "expected --time-unit with one of s (1 Hz, 399 s), ms (1000 Hz, 0.399 s)" in said

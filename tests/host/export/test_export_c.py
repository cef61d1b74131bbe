"""The C header: compiled without a warning as C99 and as C++, and right to single precision."""

import ctypes
import shutil
import subprocess

import numpy as np
import pytest

from sixflip.record import correction_record
from sixflip.record.correction import Correction, correction_of
from sixflip_host import record_terms
from sixflip_host.cli import main
from sixflip_host.record_terms import TERMS
from tests.worlds.written_records import make_record

COMPILERS = {"c99": ["gcc", "-std=c99", "-x", "c"], "c++": ["g++", "-std=c++11", "-x", "c++"]}
ALL = tuple(name for _, name in TERMS)
SOURCE = """
#include "sixflip_correction.h"
#include "sixflip_correction.h"
#ifdef __cplusplus
extern "C" {
#endif
void all(const int16_t *samples, int n, const float *rest, float *out);
#ifdef __cplusplus
}
#endif
void all(const int16_t *samples, int n, const float *rest, float *out)
{
    int i;
#if SIXFLIP_HAS_GYRO
    float offset[3];
    if (rest)
        sixflip_gyro_rest(rest, offset);
    else
        sixflip_gyro_offset(offset);
    for (i = 0; i < n; i++)
        sixflip_correct(samples + 7 * i, offset, out + 6 * i, out + 6 * i + 3);
#else
    (void)rest;
    for (i = 0; i < n; i++)
        sixflip_accel(samples + 7 * i, out + 6 * i);
#endif
}
"""


def header(folder, record):
    path = folder / "record_a.bin"
    path.write_bytes(correction_record.encode(record))
    output = folder / "sixflip_correction.h"
    assert main(["export", str(path), "-o", str(output)]) == 0
    return output.read_text()


def compiled(folder, language):
    """The library of SOURCE with the header in that folder, no warning allowed."""
    command = COMPILERS[language]
    if shutil.which(command[0]) is None:
        pytest.skip("no %s to compile the header with" % command[0])
    (folder / "source").write_text(SOURCE)
    subprocess.run([*command, "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror", "-O1",
                    "-shared", "-fPIC", "-I", str(folder), str(folder / "source"), "-o",
                    str(folder / "library.so")], check=True, timeout=60)
    return ctypes.CDLL(str(folder / "library.so"))


def pointer(array, kind):
    return None if array is None else array.ctypes.data_as(ctypes.POINTER(kind))


def samples(n=2000, seed=4):
    """Random counts (n, 7), the temperature between some 10 and 60 °C of an MPU6050."""
    rng = np.random.default_rng(seed)
    counts = rng.integers(-32768, 32768, (n, 7)).astype(np.int16)
    counts[:, 6] = rng.integers(-9000, 8000, n)
    return counts


def run(library, counts, rest=None):
    out = np.zeros((len(counts), 6), np.float32)
    library.all(pointer(counts, ctypes.c_int16), len(counts), pointer(rest, ctypes.c_float),
                pointer(out, ctypes.c_float))
    return out


def by_python(correction, counts):
    return np.array([correction.apply(row, [0.0] * 6) for row in counts.tolist()])


def single_precision(correction, counts):
    """What rounding to 24 bits may do to sums of a dozen products of that size, and no more."""
    sizes = [np.abs(counts[:, at:at + 3].astype(float)) @ np.abs(np.array(M[:3]))
             + np.abs(np.array(M[3])) for at, M in ((0, correction.accel), (3, correction.gyro))]
    return 12 * 2.0 ** -24 * np.hstack([np.repeat(one.sum(axis=1)[:, None], 3, axis=1)
                                        for one in sizes])


def with_terms(names):
    record = make_record()
    record.temp_c = 24.0
    record.terms = []
    for name in names:
        record_terms.put(record, name, dict(
            axes=[0, 1, 2], origin="sessions held out", source="warming.csv", also="",
            before=6.0, after=2.0, floor=None, t0_c=28.0, low_c=15.0, high_c=40.0,
            temp_lsb_per_c=340.0, temp_offset_c=36.53, sigma_k1=[0.1] * 3, sigma_k2=[0.1] * 3,
            k1=[0.05, -0.07, 0.18], k2=[0.001, 0.0, -0.003], sigma=[[0.1] * 3] * 3,
            k=[[0.1, -0.05, 0.02], [0.0, 0.2, 0.03], [-0.04, 0.01, 0.15]]))
    return record


@pytest.mark.parametrize("language", COMPILERS)
@pytest.mark.parametrize("names", [(), ("accel_thermal_bias",), ("g_sensitivity",), ALL],
                         ids=["plain", "thermal", "coupling", "every term"])
def test_the_header_is_the_correction(tmp_path, language, names):
    record = with_terms(names)
    text = header(tmp_path, record)
    assert all(name in text for name in names)
    library = compiled(tmp_path, language)
    counts = samples()
    correction = correction_of(record)
    limit = single_precision(correction, counts)
    assert (np.abs(run(library, counts) - by_python(correction, counts)) <= limit).all()
    assert limit.max() < 2e-4       # m/s², rad/s, at full scale
    if names:                       # and the terms are not nothing
        plain = by_python(Correction(record), counts)
        assert np.abs(plain - by_python(correction, counts)).max() > 50 * limit.max()


@pytest.mark.parametrize("names", [(), ALL], ids=["plain", "every term"])
def test_bias_of_a_rest(tmp_path, names):
    record = with_terms(names)
    header(tmp_path, record)
    library = compiled(tmp_path, "c99")
    rest = np.array([101.5, -32.25, 8007.0, 50.5, -12.0, 3.25, -4000.0], np.float32)
    correction = correction_of(record)
    correction.set_rest(rest.tolist())
    counts = samples(200)
    assert (np.abs(run(library, counts, rest) - by_python(correction, counts))
            <= single_precision(correction, counts)).all()


def test_without_mounting_and_gyro_measured(tmp_path):
    record = make_record(False, False)
    header(tmp_path, record)
    counts = samples(200)
    correction = correction_of(record)
    assert (np.abs(run(compiled(tmp_path, "c99"), counts) - by_python(correction, counts))
            <= single_precision(correction, counts)).all()


def test_a_sensor_without_gyro(tmp_path):
    record = make_record(False, False)
    record.chip, record.gyro_lsb_per_dps, record.gyro_range_dps = "adxl345", 0.0, 0
    record.accel_range_g, record.accel_lsb_per_g = 16, 256
    text = header(tmp_path, record)
    assert "SIXFLIP_HAS_GYRO 0" in text and "gyro_table" not in text
    counts = samples(200)
    correction = correction_of(record)
    out = run(compiled(tmp_path, "c99"), counts)
    assert (np.abs(out - by_python(correction, counts))
            <= single_precision(correction, counts)).all()


def test_the_header_says_what_it_is(tmp_path):
    text = header(tmp_path, make_record())
    assert "Formula: corrected_j = c_x M[0][j]" in text
    assert "raw acceleration = counts / 8192" in text and "turned into the robot's axes" in text
    assert "malloc" not in text and "double" not in text


def test_what_a_record_says_cannot_leave_the_comment(tmp_path):
    record = make_record()
    record.chip = "*/int x;/*??/\\"
    text = header(tmp_path, record)
    assert text.count("*/") == text.count("/*") and "??" not in text
    assert text.index("*/") > text.index("Formula")
    compiled(tmp_path, "c99")


@pytest.mark.parametrize("name", ["imu_calib", "imufusion"])
def test_formats_without_a_place_for_terms_say_so(tmp_path, name):
    for record, says in ((with_terms(["g_sensitivity"]), True), (make_record(), False)):
        (tmp_path / "r.bin").write_bytes(correction_record.encode(record))
        assert main(["export", str(tmp_path / "r.bin"), "--format", name, "-o",
                     str(tmp_path / "out")]) == 0
        text = (tmp_path / "out").read_text()
        assert ("NOT in this file, which has no place for it: g_sensitivity"
                in text) == says

"""Hostile files: an answer in one line, no hang, and memory in proportion to the file.

Stated bound: what the tool itself needs (its libraries, about 150 MB) and MOST_MB beyond it,
or eight times the file if that is more. Each file is read by a process of its own, which the
system ends if it takes more than SECONDS of processor time or LIMIT of address space.
"""

import gzip
import json
import os
import resource
import struct
import subprocess
import sys
import zlib
from binascii import crc32

import numpy as np
import pytest

from sixflip_host.capture import capture_file

MOST_MB = 350
SECONDS = 60
LIMIT = 6 << 30
RUN = """
import json, sys
from sixflip_host.cli import main
code = main(json.loads(sys.argv[1]))
with open("/proc/self/status") as file:     # ru_maxrss begins with what the parent had
    print("PEAK", int(file.read().split("VmHWM:")[1].split()[0]) // 1024)
sys.exit(code)
"""
HEAD = (b'# sixflip-capture 1\n# {"sensor": "other", "rate_hz": 100, "accel_lsb_per_g": 16384}\n'
        b"t_us,ax,ay,az\n")
MILLION = 1 << 20


def bomb(text, repeat):
    """gzip of text and then a gigabyte or more of the same row. What follows a full flush knows
    nothing of what was before it, so that one block's bytes are those of every other."""
    packer, block = zlib.compressobj(9, wbits=-zlib.MAX_WBITS), b"0,1,2,3\n" * (MILLION // 8)
    first, again = (packer.compress(part) + packer.flush(zlib.Z_FULL_FLUSH)
                    for part in (text, block))
    crc = crc32(text)
    for _ in range(repeat):
        crc = crc32(block, crc)
    return b"\x1f\x8b\x08\0\0\0\0\0\0\xff" + first + again * repeat + packer.flush() \
        + struct.pack("<II", crc, len(text) + repeat * len(block) & 0xFFFFFFFF)


def zstd_of_zeros(size):
    """A zstd frame of so many bytes."""
    from rosbags.rosbag2 import storage_mcap
    packer = storage_mcap.zstd.ZstdCompressor()
    block = bytes(MILLION)
    return b"".join([packer.compress(block) for _ in range(size // MILLION)] + [packer.flush()])


def mcap_bomb(size):
    """An MCAP with one chunk that says what it unpacks to, and does."""
    def sized(data):
        return struct.pack("<I", len(data)) + data

    def record(code, data):
        return bytes([code]) + struct.pack("<Q", len(data)) + data
    packed = zstd_of_zeros(size)
    chunk = struct.pack("<QQQI", 0, 1, size, 0) + sized(b"zstd") + \
        struct.pack("<Q", len(packed)) + packed
    return b"\x89MCAP0\r\n" + record(1, sized(b"ros2") + sized(b"")) + record(6, chunk) + \
        record(2, bytes(20)) + b"\x89MCAP0\r\n"


def compressed_bag(folder, size):
    """A rosbag2 folder whose one file is packed by zstd."""
    (folder / "imu.db3.zstd").write_bytes(zstd_of_zeros(size))
    (folder / "metadata.yaml").write_text(json.dumps({"rosbag2_bagfile_information": {
        "version": 4, "storage_identifier": "sqlite3", "relative_file_paths": ["imu.db3.zstd"],
        "duration": {"nanoseconds": 1}, "starting_time": {"nanoseconds_since_epoch": 0},
        "message_count": 1, "topics_with_message_count": [], "compression_format": "zstd",
        "compression_mode": "FILE"}}))


def board_header(length, declared):
    """The start of a board's file that claims more than there is."""
    return b"6CAP" + struct.pack("<BBI", 1, 1, declared)[:6] + b"{" * length


def record_of(size):
    """A record that is one unknown section after the other, with a right CRC."""
    from sixflip.record import correction_record
    data = bytearray(correction_record.encode(correction_record.Record())[:-4])
    data += b"\xff\xff\xff" + b"\0" * 65535
    del data[size:]
    struct.pack_into("<H", data, 6, (len(data) + 4) & 0xFFFF)
    return bytes(data) + struct.pack("<I", crc32(data))


HOSTILE = {
    "gzip bomb of rows": ("x.csv.gz", lambda: bomb(HEAD, 600), ("solve",)),
    "gzip of a million empty members": ("x.csv.gz", lambda: gzip.compress(b"") * 400000,
                                        ("solve",)),
    "gzip bomb for import": ("x.csv.gz", lambda: bomb(b"ax,ay,az\n", 600),
                             ("import", "-o", "OUT", "--rate", "100", "--accel-lsb", "1")),
    "gzip bomb of a row in four columns": ("x.csv.gz", lambda: bomb(b"ax,ay,az,b\n", 400),
        ("import", "-o", "OUT", "--rate", "100", "--accel-lsb", "1", "--limit", "1000000")),
    "gzip bomb of numbers in units": ("x.csv.gz", lambda: bomb(b"ax,ay,az,b\n", 400),
        ("import", "-o", "OUT", "--rate", "100", "--units", "si", "--limit", "1000000")),
    "gzip bomb of empty lines": ("x.csv.gz", lambda: gzip.compress(b"ax,ay,az\n" + b"\n" * (
        100 * MILLION)), ("import", "-o", "OUT", "--rate", "100", "--accel-lsb", "1")),
    "MCAP bomb": ("x.mcap", lambda: mcap_bomb(1 << 30), ("import", "-o", "OUT", "--limit",
                                                         "1000000")),
    "nested brackets": ("x.csv", lambda: b"# sixflip-capture 1\n# " + b"[" * 10**8, ("show",)),
    "nested brackets, short": ("x.csv", lambda: b"# sixflip-capture 1\n# " + b"[" * 10**6
                               + b"\nt_us,ax,ay,az\n", ("show",)),
    "100,000 keys, one twice": ("x.csv", lambda: b"# sixflip-capture 1\n# {" + b",".join(
        b'"%d":0' % (k % 80000) for k in range(80001)) + b"}\nt_us,ax,ay,az\n", ("show",)),
    "a row of 10 MB of commas": ("x.csv", lambda: HEAD + b"," * 10 * MILLION + b"\n", ("solve",)),
    "a row of 10 MB of digits": ("x.csv", lambda: HEAD + b"0,1,2," + b"9" * 10 * MILLION + b"\n",
                                 ("solve",)),
    "column names of 900 KB": ("x.csv", lambda: HEAD[:-14] + b"t_us," * 180000 + b"\n",
                               ("solve",)),
    "one column repeated": ("x.csv", lambda: b"# sixflip-capture 1\n" + b"\n" * 10 * MILLION,
                            ("solve",)),
    "a million poses": ("x.csv", lambda: HEAD.replace(b"az\n", b"az,pose\n") + b"".join(
        b"%d,1,2,16384,L%d\n" % (k, k % 2000 + 1) for k in range(100000)), ("show", "--json")),
    "board's file, huge lengths": ("x.bin", lambda: board_header(1000, 2**32 - 1), ("show",)),
    "board's file of noise": ("x.bin", lambda: b"6CAP" + b"\xff" * 10 * MILLION, ("verify", "x")),
    "record of one section": ("x.bin", lambda: record_of(70000), ("show",)),
    "record of 10 MB": ("x.bin", lambda: b"6FLP" + b"\xff" * 10 * MILLION, ("show",)),
    "csv of one line": ("x.csv", lambda: b"1," * 5 * MILLION + b"1\n",
                        ("import", "-o", "OUT", "--rate", "100", "--accel-lsb", "1",
                         "--columns", "ax,ay,az")),
    "sections nested": ("x.csv", lambda: b"1,2,3\n", ("import", "-o", "OUT", "--rate", "100",
                        "--columns", "ax,ay,az", "--accel-lsb", "1", "--sections", "NESTED")),
    "plan nested": ("x.json", lambda: b"[" * 10**8, ("plan", "--protocol", "x")),
    "scenario nested": ("x.toml", lambda: b"a=" + b"[" * 10**6, ("simulate", "-o", "OUT")),
    "scenario of dots": ("x.toml", lambda: b"a." * 10**5 + b"b=1", ("simulate", "-o", "OUT")),
}


def limits():
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 5))
    resource.setrlimit(resource.RLIMIT_AS, (LIMIT, LIMIT))


@pytest.fixture(scope="module")
def of_the_tool_itself():
    """MB that reading an honest little file takes, libraries included."""
    done = subprocess.run([sys.executable, "-c", RUN, json.dumps(["--version"])],
                          capture_output=True, text=True)
    return int(done.stdout.split()[-1])


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_file(name, tmp_path, of_the_tool_itself):
    file, make, (verb, *options) = HOSTILE[name]
    path = tmp_path / file
    path.write_bytes(make())
    words = [verb] if "--protocol" in options else [verb, str(path)]
    for option in options:
        if option == "NESTED":
            (tmp_path / "nested.json").write_bytes(b"[" * 10**7)
            option = str(tmp_path / "nested.json")
        words.append({"OUT": str(tmp_path / "out.csv"), "x": str(path)}.get(option, option))
    done = subprocess.run(
        [sys.executable, "-c", RUN, json.dumps(words)], capture_output=True, text=True,
        preexec_fn=limits, cwd=tmp_path, env=dict(os.environ, OPENBLAS_NUM_THREADS="1"))
    assert done.returncode in (0, 4), done.stderr[-2000:] + done.stdout[-500:]
    assert done.stderr.count("\n") == (done.returncode != 0)
    assert len(done.stderr) < 1200
    peak = int(done.stdout.split()[-1]) - of_the_tool_itself
    assert peak < max(MOST_MB, 8 * path.stat().st_size >> 20), "%d MB" % peak


def measured(words, folder):
    """(exit code, error line, MB at most) of a command in a process of its own."""
    done = subprocess.run(
        [sys.executable, "-c", RUN, json.dumps(words)], capture_output=True, text=True,
        preexec_fn=limits, cwd=folder, env=dict(os.environ, OPENBLAS_NUM_THREADS="1"))
    return done.returncode, done.stderr, int(done.stdout.split()[-1])


@pytest.mark.parametrize("words", (["show", "/dev/zero"], ["solve", "/dev/zero"],
                                   ["import", "/dev/zero", "-o", "OUT", "--rate", "1"],
                                   ["restore", "--from", "/dev/zero", "--port", "local:none"],
                                   ["plan", "--protocol", "/dev/zero"]))
def test_a_file_without_end_is_not_read_to_its_end(words, tmp_path):
    code, said, peak = measured(words, tmp_path)
    assert (code, said.count("\n")) == (4, 1), said
    assert peak < 350


def test_a_compressed_bag_is_unpacked_no_further_than_the_limit(tmp_path):
    (tmp_path / "bag").mkdir()
    compressed_bag(tmp_path / "bag", 1 << 30)
    code, said, peak = measured(["import", "bag", "-o", "out.csv", "--limit", "100000"], tmp_path)
    assert (code, said.count("\n")) == (4, 1), said
    assert "File too large" in said and peak < 350


BYTES_A_SAMPLE = 50
SAMPLES = (100_000, 400_000)    # the slope between them: what a reader takes whatever the file
READ = """
import sys
from sixflip_host.capture import capture_file
from sixflip_host.verbs import import_recording
from sixflip_host.cli import parser_for
%s
with open("/proc/self/status") as file:
    print(int(file.read().split("VmHWM:")[1].split()[0]) * 1024)
"""
CAPTURE = "capture_file.read(sys.argv[1])"
IMPORT = "import_recording.run(parser_for('import').parse_args(sys.argv[1:]))"
META = {"sensor": "mpu6050", "rate_hz": 100, "accel_lsb_per_g": 16384, "gyro_lsb_per_dps": 131,
        "temp_lsb_per_c": 340, "temp_offset_c": 36.53}


def board_file(counts):
    """The bytes of a board's file of int16 (n, 7), without delta coding: its longest form."""
    from sixflip.capture import blocks as cb

    def sealed(kind, payload):
        block = struct.pack(cb.BLOCK, kind, 0, len(payload)) + payload
        return block + struct.pack("<I", crc32(block))
    out = [cb.header(json.dumps(META).encode(), cb.ACCEL | cb.GYRO | cb.TEMP)]
    for first in range(0, len(counts), 2000):
        some = counts[first:first + 2000]
        steps = np.where(np.arange(len(some)), 10000, 0)
        out.append(sealed(cb.SAMPLES, struct.pack(cb.TIME, first // 100, 0, len(some))
                          + np.c_[steps, some].astype("<i2").tobytes()))
    return b"".join(out) + sealed(cb.END, struct.pack(cb.FINISH, len(counts), cb.COMPLETE))


@pytest.fixture(scope="module")
def long_sessions(tmp_path_factory):
    """A folder for each of SAMPLES: rests of 40 s as text, packed text, a board's file and
    somebody else's CSV."""
    folder = tmp_path_factory.mktemp("long")
    for samples in SAMPLES:
        at = folder / str(samples)
        at.mkdir()
        counts = np.random.default_rng(1).integers(-40, 40, (samples, 7)).astype(np.int16)
        up = np.arange(samples) // 4000 % 6
        counts[np.arange(samples), up % 3] += np.where(up < 3, 16384, -16384).astype(np.int16)
        capture = capture_file.Capture(META, np.arange(samples) * 10000, counts[:, :3],
                                       counts[:, 3:6], counts[:, 6])
        capture_file.write(at / "x.csv", capture)
        capture_file.write(at / "x.csv.gz", capture)
        (at / "x.bin").write_bytes(board_file(counts))
        np.savetxt(at / "si.csv", np.c_[np.arange(samples) / 100, counts[:, :3] * 0.000598,
                                        counts[:, 3:6] * 0.000133], "%.7g", ",", comments="",
                   header="t,ax,ay,az,gx,gy,gz")
    return folder


@pytest.mark.parametrize("how, words", [
    (CAPTURE, ["x.csv"]), (CAPTURE, ["x.csv.gz"]), (CAPTURE, ["x.bin"]),
    (IMPORT, ["si.csv", "-o", "x", "--units", "si", "--time-column", "t", "--time-unit", "s"])])
def test_no_file_takes_more_than_fifty_bytes_a_sample(how, words, long_sessions):
    most = []
    for samples in SAMPLES:
        done = subprocess.run([sys.executable, "-c", READ % how, *words], capture_output=True,
                              text=True, cwd=long_sessions / str(samples))
        assert done.returncode == 0, done.stderr
        most.append(int(done.stdout.split()[-1]))
    assert 10 < (most[1] - most[0]) / (SAMPLES[1] - SAMPLES[0]) < BYTES_A_SAMPLE

"""What a sample may cost. What a session and a solve may: tests/on_qemu."""


def test_a_sample_allocates_nothing(micropython):
    done = micropython("locked_sampling.py", heap="128k")
    assert done.returncode == 0, done.stdout + done.stderr
    words = done.stdout.split()
    samples, locked, poses = int(words[1]), int(words[3]), int(words[5])
    assert poses == 12
    assert locked > 0.9 * samples
    assert "float True big True tuple True" in done.stdout  # the lock does catch them

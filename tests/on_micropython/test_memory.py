"""What the sampling loop and a whole session may cost."""


def test_a_sample_allocates_nothing(micropython):
    done = micropython("locked_sampling.py", heap="128k")
    assert done.returncode == 0, done.stdout + done.stderr
    words = done.stdout.split()
    samples, locked, poses = int(words[1]), int(words[3]), int(words[5])
    assert poses == 12
    assert locked > 0.9 * samples
    assert "float True big True tuple True" in done.stdout  # the lock does catch them


def test_a_whole_session_and_its_capture_in_64_kb(micropython):
    """64-bit objects: on the 32-bit boards it is about half. The operator is included."""
    done = micropython("session_in_a_small_heap.py", heap="64k")
    assert done.returncode == 0, done.stdout + done.stderr
    words = done.stdout.split()
    assert words[1] == "12"
    assert int(words[3]) > 16 * 12 * 400


def test_importing_and_solving_from_pose_means_in_24_kb(micropython):
    done = micropython("solve_in_a_small_heap.py", heap="24k")
    assert done.returncode == 0, done.stdout + done.stderr
    words = done.stdout.split()
    assert words[1] == "True"
    assert 3 <= int(words[3]) < 20

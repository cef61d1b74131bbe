"""Threads of the linear algebra: none beside those that work on whole sensors."""
import os
import subprocess
import sys
from pathlib import Path

import pytest

TASKS = Path("/proc/self/task")
COUNTED = "from sixflip_host import cli; cli.load('diagnose'); import numpy, os; " \
          "numpy.linalg.inv(numpy.eye(300)); print(len(os.listdir('%s')))" % TASKS


@pytest.mark.skipif(not TASKS.is_dir(), reason="threads are counted in /proc, which Linux has")
def test_diagnose_keeps_the_linear_algebra_to_one_thread():
    plain = {k: v for k, v in os.environ.items() if not k.endswith("_NUM_THREADS")}
    done = subprocess.run([sys.executable, "-c", COUNTED], env=plain, capture_output=True,
                          text=True, check=True)
    assert int(done.stdout) == 1

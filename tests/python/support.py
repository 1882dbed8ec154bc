# SPDX-License-Identifier: GPL-3.0-or-later
"""What several tests of the Python package need."""
import contextlib
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings

import numpy as np

import scanmill

ROOT = pathlib.Path(__file__).resolve().parents[2]
KITTEN = ROOT / "build/data/points_3/kitten.xyz"

needs_kitten = unittest.skipUnless(KITTEN.exists(), "skipped: needs build/data, which make data fetches")


class InFolder(unittest.TestCase):
    """Runs every test in an empty working folder, with warnings as errors unless the test expects them."""

    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        before = os.getcwd()
        os.chdir(self.folder)
        self.addCleanup(os.chdir, before)
        self.enterContext(warnings.catch_warnings())
        warnings.simplefilter("error", scanmill.ScanmillWarning)

    def assertRefuses(self, text, call, error=scanmill.Error):
        with self.assertRaises(error) as caught:
            call()
        self.assertIn(text, str(caught.exception))
        return caught.exception


def cube(side=1.0):
    """A mesh of a cube: 8 vertices, 12 triangles."""
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float) * side
    faces = [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]]
    return scanmill.Mesh(corners, faces)


def random_points(count, seed=1):
    return scanmill.Points(np.random.default_rng(seed).random((count, 3)))


def resident_megabytes():
    """The memory of this process."""
    pages = int(pathlib.Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


@contextlib.contextmanager
def interrupt_after(seconds, times):
    """Sends SIGINT to this process once. Appends the moment to `times`."""

    def send():
        time.sleep(seconds)
        times.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=send)
    thread.start()
    try:
        yield
    finally:
        thread.join()


def python(code, **options):
    """Runs code in a new interpreter."""
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, **options)

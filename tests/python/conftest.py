import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

sys.dont_write_bytecode = True
import libdem  # noqa: E402

TESTDATA = pathlib.Path(__file__).parents[2] / "testdata"


@pytest.fixture(scope="session")
def testdata():
    return TESTDATA


@pytest.fixture
def dem(tmp_path):
    """Runs the command line in a folder of its own: dem("fill", "in.tif", "out.tif")."""
    def run(*arguments):
        done = subprocess.run([os.environ["DEM_BINARY"], *map(str, arguments)], cwd=tmp_path, capture_output=True,
                              text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout
    return run


@pytest.fixture(scope="session")
def whole():
    return libdem.read(TESTDATA / "jacksboro.tif")


@pytest.fixture(scope="session")
def holed(whole):
    return libdem.sample(whole, voids=0.05, seed=3)


@pytest.fixture
def hills():
    """A small array of heights without holes."""
    rows, cols = np.mgrid[0:40, 0:50]
    return (300 + 80 * np.sin(cols / 7) + 60 * np.cos(rows / 5) + cols).astype(np.float32)


def equal_bits(a, b):
    """Whether two float arrays have the same bits."""
    return a.shape == b.shape and a.dtype == b.dtype and a.tobytes() == b.tobytes()

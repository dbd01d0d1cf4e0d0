"""One DEM is filled through every interface of the library, and the cells are compared bit by bit."""

import os
import subprocess

import pytest
from conftest import TESTDATA, equal_bits

import libdem

DEM = os.environ["DEM_BINARY"]
DOORS = os.environ["DEM_DOORS"]


def run(*words):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done


def by_command(holes, out, *options):
    run(DEM, "fill", holes, out, *options)


def by_resume(holes, out):
    """A task fills half of the windows, and a run that resumes fills the others."""
    by_command(holes, out, "--task", "1/2")
    done = run(DEM, "fill", holes, out, "--resume")
    assert "resumed: " in done.stderr


def by_tasks(holes, out):
    for task in range(1, 4):
        by_command(holes, out, "--task", f"{task}/3")
    by_command(holes, out, "--resume")


def by_python(holes, out):
    libdem.write(out, libdem.fill(libdem.read(holes)).dem)


def by_dask(holes, out):
    distributed = pytest.importorskip("distributed", reason="python3-distributed is missing")
    from libdem.distributed import fill_mosaic
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True,
                                  dashboard_address=None) as cluster, distributed.Client(cluster) as client:
        fill_mosaic([holes], out.parent / "tiles", client=client)
    os.rename(out.parent / "tiles" / holes.name, out)


DOORS_BY_NAME = {
    "C++": lambda holes, out: run(os.path.join(DOORS, "fill_in_cpp"), holes, out),
    "C": lambda holes, out: run(os.path.join(DOORS, "fill_in_c"), holes, out),
    "Python": by_python,
    "memory": lambda holes, out: by_command(holes, out, "--memory", "400M"),
    "one thread": lambda holes, out: by_command(holes, out, "--threads", "1"),
    "resume": by_resume,
    "tasks": by_tasks,
    "Dask": by_dask,
}


@pytest.fixture(scope="module")
def problem(tmp_path_factory):
    """Voids of a tile in degrees, whose cells differ from row to row, and what the command line makes of them."""
    folder = tmp_path_factory.mktemp("doors")
    run(DEM, "sample", TESTDATA / "jacksboro.tif", folder / "holes.tif", "--voids", "5%", "--seed", "4")
    by_command(folder / "holes.tif", folder / "filled.tif")
    return folder / "holes.tif", libdem.read(folder / "filled.tif")


@pytest.mark.parametrize("door", DOORS_BY_NAME)
def test_the_same_cells(door, problem, tmp_path):
    holes, expected = problem
    DOORS_BY_NAME[door](holes, tmp_path / "out.tif")
    got = libdem.read(tmp_path / "out.tif")
    assert got.known.all() and expected.known.all()
    assert equal_bits(got.z, expected.z)

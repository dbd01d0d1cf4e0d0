"""Mosaics on a Dask cluster of two processes: the bits of one `dem fill`, whatever happens on the way."""

import os
import pathlib
import resource
import signal
import subprocess
import threading
import time

import numpy as np
import pytest
from conftest import equal_bits

import libdem

distributed = pytest.importorskip("distributed", reason="python3-distributed is missing")
from libdem.distributed import FOLDER, fill_mosaic  # noqa: E402

SIDE = 301  # of a tile; neighbours share a row or column


@pytest.fixture(scope="module")
def client():
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True,
                                  dashboard_address=None) as cluster, distributed.Client(cluster) as client:
        yield client


def holed(rows, cols, seed=1):
    whole = libdem.generate("noise", (rows, cols), seed=seed, spacing=30)
    return libdem.sample(whole, voids=0.08, seed=seed)


def cut(dem, folder, side=SIDE, skip=()):
    """Tiles that share their edges, as SRTM's do."""
    os.makedirs(folder)
    x, dx, _, y, _, dy = dem.to_world
    files = []
    for row in range(0, dem.shape[0] - 1, side - 1):
        for col in range(0, dem.shape[1] - 1, side - 1):
            part = np.s_[row:row + side, col:col + side]
            if (row // (side - 1), col // (side - 1)) in skip:
                continue
            files.append(str(folder / f"r{row}c{col}.tif"))
            libdem.write(files[-1], dem.z[part], known=dem.known[part], nodata=-9999,
                         to_world=(x + col * dx, dx, 0, y + row * dy, 0, dy))
    return files


@pytest.fixture(scope="module")
def world(tmp_path_factory):
    """Tiles, one of them missing, and the whole as the command line fills it."""
    folder = tmp_path_factory.mktemp("world")
    dem = holed(3 * (SIDE - 1) + 1, 3 * (SIDE - 1) + 1)
    gap = np.zeros(dem.shape, bool)
    gap[SIDE:2 * (SIDE - 1), SIDE:2 * (SIDE - 1)] = True  # the missing tile, but for its neighbours' edges
    whole = libdem.Dem(dem.z, dem.known & ~gap, to_world=dem.to_world)
    libdem.write(folder / "whole.tif", whole)
    subprocess.run([os.environ["DEM_BINARY"], "fill", "whole.tif", "filled.tif", "-q", "--where", "cells < 50000"],
                   cwd=folder, check=True)
    files = cut(dem, folder / "tiles", skip=[(1, 1)])
    return files, libdem.read(folder / "filled.tif"), libdem.read(folder / "whole.tif")


def write_vrt(files, path):
    libdem.distributed._write_vrt(files, [libdem._core.describe(f) for f in files], None, str(path))


def options(world, **more):
    return {"where": "cells < 50000", "bundle_cells": 20_000, **more}


def assert_same(out_dir, filled, side=SIDE):
    files = sorted(p for p in pathlib.Path(out_dir).iterdir())
    assert len(files) == 8, files
    for file in files:
        row, col = map(int, file.stem[1:].split("c"))
        got = libdem.read(file)
        part = np.s_[row:row + side, col:col + side]
        assert np.array_equal(got.known, filled.known[part]), file
        assert equal_bits(np.where(got.known, got.z, 0), np.where(filled.known, filled.z, 0)[part].copy()), file


def test_tiles_are_those_of_one_fill_bit_for_bit(world, client, tmp_path):
    files, filled, whole = world
    parts = []
    report = fill_mosaic(files, tmp_path / "out", client, progress=lambda part, what: parts.append(part),
                         **options(world))
    assert_same(tmp_path / "out", filled)
    assert report["tiles"] == 8 and report["bundles"] > 10
    assert report["filled"] == np.count_nonzero(filled.known) - np.count_nonzero(whole.known)
    assert report["unknown"] == np.count_nonzero(~whole.known)
    assert parts == sorted(parts) and parts[-1] == 1


def test_a_folder_and_a_vrt_are_the_same_mosaic(world, client, tmp_path):
    files, filled, _ = world
    fill_mosaic(os.path.dirname(files[0]), tmp_path / "a", client, **options(world))
    assert_same(tmp_path / "a", filled)
    write_vrt(files, tmp_path / "m.vrt")
    fill_mosaic(tmp_path / "m.vrt", tmp_path / "b", client, **options(world, bundle_cells=10**9))
    assert_same(tmp_path / "b", filled)


def test_tiles_of_hgt(client, tmp_path):
    dem = holed(1201, 2401, seed=3)
    os.makedirs(tmp_path / "in")
    values = np.where(dem.known, np.rint(dem.z), -32768).astype(">i2")
    for col, name in enumerate(["N46E008.hgt", "N46E009.hgt"]):
        values[:, 1200 * col:1200 * col + 1201].tofile(tmp_path / "in" / name)
    fill_mosaic(tmp_path / "in", tmp_path / "out", client, method="mcmd")
    subprocess.run([os.environ["DEM_BINARY"], "fill", "in", "whole.tif", "-q", "-m", "mcmd"], cwd=tmp_path, check=True)
    whole = libdem.read(tmp_path / "whole.tif").z
    for col, name in enumerate(["N46E008.hgt", "N46E009.hgt"]):
        assert (tmp_path / "out" / name).stat().st_size == 2 * 1201 * 1201
        assert np.array_equal(libdem.read(tmp_path / "out" / name).z, whole[:, 1200 * col:1200 * col + 1201])


def in_thread(call):
    result = []

    def work():
        try:
            result.append(call())
        except BaseException as error:
            result.append(error)
    thread = threading.Thread(target=work)
    thread.start()
    return thread, result


def wait_for(condition, seconds=240):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.01)


def journals(folder):
    return [p for p in pathlib.Path(folder, FOLDER).glob("journal-*") if p.suffix != ".part"]


def test_a_worker_that_dies_in_the_middle_changes_no_bit(world, client, tmp_path):
    files, filled, _ = world
    pids = sorted(client.run(os.getpid).values())
    settings = options(world, bundle_cells=5000)
    thread, result = in_thread(lambda: fill_mosaic(files, tmp_path / "out", client, **settings))
    wait_for(lambda: len(journals(tmp_path / "out")) >= 3 or result)
    assert not result, "the run was over before a worker could be killed"
    os.kill(pids[0], signal.SIGKILL)
    thread.join()
    assert isinstance(result[0], dict), result
    assert_same(tmp_path / "out", filled)
    assert pids[0] not in client.run(os.getpid).values()  # Dask may take long to start another


def test_the_same_call_goes_on_after_a_stop(world, client, tmp_path):
    files, filled, _ = world

    def stop_at(where):
        def progress(part, what):
            if part >= where:
                raise KeyboardInterrupt
        return progress
    for where in 0.1, 0.3, 0.9:
        with pytest.raises(KeyboardInterrupt):
            fill_mosaic(files, tmp_path / "out", client, progress=stop_at(where), **options(world))
    seen = []
    report = fill_mosaic(files, tmp_path / "out", client, progress=lambda part, what: seen.append(what),
                         **options(world))
    assert "looking for holes" not in seen and report["resumed"] == report["windows"]
    assert_same(tmp_path / "out", filled)


def test_a_full_disk_is_told_and_gone_on_from(world, client, tmp_path):
    files, filled, _ = world
    limits = client.run(resource.getrlimit, resource.RLIMIT_FSIZE)
    client.run(resource.setrlimit, resource.RLIMIT_FSIZE, (2000, limits[next(iter(limits))][1]))
    with pytest.raises(OSError, match="File too large") as error:
        fill_mosaic(files, tmp_path / "out", client, **options(world))
    assert "\n" not in str(error.value)
    client.run(resource.setrlimit, resource.RLIMIT_FSIZE, next(iter(limits.values())))
    fill_mosaic(files, tmp_path / "out", client, **options(world))
    assert_same(tmp_path / "out", filled)


def test_what_is_wrong_is_told_in_one_line(world, client, tmp_path):
    files, _, _ = world
    half = tmp_path / "half.tif"
    half.write_bytes(pathlib.Path(files[-1]).read_bytes()[:60000])
    cell = np.zeros((5, 5), np.float32)
    for name, dtype, x in [("a", np.float32, 0), ("b", np.int16, 5), ("c", np.float32, 5.4)]:
        libdem.write(tmp_path / f"{name}.tif", cell.astype(dtype), to_world=(x, 1, 0, 0, 0, -1))
    (tmp_path / "empty").mkdir()
    (tmp_path / "short").mkdir()
    (tmp_path / "short" / "N46E008.hgt").write_bytes(bytes(1000))
    one = [str(tmp_path / "a.tif")]
    for sources, keywords, kind, message in [
            (files[:2] + ["gone.tif"], {}, OSError, "gone.tif: No such file or directory"),
            (tmp_path / "nowhere.vrt", {}, OSError, "nowhere.vrt: No such file"),
            (tmp_path / "empty", {}, OSError, "empty: is a folder that holds no .hgt and no .tif"),
            (tmp_path / "short", {}, OSError, "N46E008.hgt: "),
            (files[:-1] + [half], options(world, retries=0), OSError, "half.tif: "),
            ([], {}, ValueError, "sources is empty"),
            (one + [str(tmp_path / "b.tif")], {}, ValueError, "b.tif: its type is Int16; must be Float32, as in"),
            (one + [str(tmp_path / "c.tif")], {}, ValueError, "c.tif: its cells do not lie on the lattice"),
            (one + one, {}, ValueError, "has the name of"),
            (one, {"method": "splin"}, ValueError, 'unknown method "splin"'),
            (one, {"curl": 1}, ValueError, 'unknown setting "curl"'),
            (one, {"where": "cells <"}, ValueError, "where = cells <"),
            (one, {"memory": "much"}, ValueError, "memory = much; must be a size above 0"),
            (one, {"memory": "50M"}, ValueError, "memory = 50M; must be at least"),
            (files, options(world, memory="130M", whole=True, bundle_cells=7), ValueError,
             "memory = 130M; must be at least .* one problem")]:
        with pytest.raises(kind, match=message) as error:
            fill_mosaic(sources, tmp_path / "out", client, overwrite=True, **keywords)
        assert "\n" not in str(error.value)
    with pytest.raises(ValueError, match="must not be the folder of the source"):
        fill_mosaic(one, tmp_path, client)


def test_what_is_there_is_not_replaced_unasked(client, tmp_path):
    z = np.arange(100, dtype=np.float32).reshape(10, 10)
    z[3, 3] = np.nan
    libdem.write(tmp_path / "a.tif", z)
    fill_mosaic([tmp_path / "a.tif"], tmp_path / "out", client)
    before = (tmp_path / "out" / "a.tif").read_bytes()
    with pytest.raises(FileExistsError, match="a.tif: exists; overwrite=True replaces it"):
        fill_mosaic([tmp_path / "a.tif"], tmp_path / "out", client)
    assert (tmp_path / "out" / "a.tif").read_bytes() == before
    fill_mosaic([tmp_path / "a.tif"], tmp_path / "out", client, overwrite=True, method="nearest")
    (tmp_path / "out" / FOLDER).mkdir()
    with pytest.raises(FileExistsError, match="is of a run with other sources or settings"):
        fill_mosaic([tmp_path / "a.tif"], tmp_path / "out", client)

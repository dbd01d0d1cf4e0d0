#!/usr/bin/env python3
"""How fast libdem.distributed fills a mosaic, and what that means for all land tiles of SRTM.

    DEM_TESTDATA=FOLDER PYTHONPATH=build/release/apps/python scripts/mosaic_speed.py [WORKERS]

Makes four tiles of 3601 x 3601 cells from SRTM tiles of 1201 x 1201 with real voids: heights on a three
times finer lattice, each unknown cell becoming nine. Prints processor time for each step.
"""
import os
import pathlib
import resource
import sys
import tempfile

import numpy as np
from distributed import Client, LocalCluster

import libdem
from libdem.distributed import fill_mosaic

TILES = 14297  # of SRTM, with land
SIDE = 3601
FROM = {"N46E008.hgt": "N42E001", "N46E009.hgt": "N28E086", "N45E008.hgt": "N46W122", "N45E009.hgt": "N36W004"}


def tile(path):
    coarse = libdem.read(path)
    fine = libdem.supersample(coarse, 3, method="mcmd", nodes=True).elevation
    known = coarse.known[np.minimum((np.arange(SIDE) + 1) // 3, 1200)][:, np.minimum((np.arange(SIDE) + 1) // 3, 1200)]
    return np.where(known, np.rint(fine), -32768).astype(">i2")


def peak_memory():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def main():
    workers = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    data = pathlib.Path(os.environ["DEM_TESTDATA"])
    with tempfile.TemporaryDirectory() as folder:
        tiles = pathlib.Path(folder, "tiles")
        tiles.mkdir()
        for name, source in FROM.items():
            found = next(data / f"{source}{end}.hgt" for end in (".void", "") if (data / f"{source}{end}.hgt").exists())
            values = tile(found)
            values.tofile(tiles / name)
            print(f"{name} from {found.name}: {(values == -32768).mean():.3%} unknown")
        with LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster, \
                Client(cluster) as client:
            report = fill_mosaic(tiles, pathlib.Path(folder, "out"), client)
            most = max(client.run(peak_memory).values())
    cells, cpu = report["cells"], report["cpu_seconds"]
    all_cpu = sum(cpu.values())
    print(f"{cells} cells, {report['unknown']} unknown ({report['unknown'] / cells:.3%}), {report['voids']} voids; "
          f"{workers} worker{'s' * (workers > 1)}, {report['seconds']['all']:.1f} s, at most {most:.0f} MB to a worker")
    for step, seconds in {**cpu, "all": all_cpu}.items():
        print(f"  {step:6} {seconds:7.2f} s of processor, "
              f"{cells / seconds / 1e6:7.2f} million cells of the mosaic a second")
    print(f"  filling alone: {report['filled'] / cpu['fill'] / 1e3:.1f} thousand unknown cells a second")
    world = TILES * (SIDE - 1) ** 2
    hours = world / (cells / all_cpu) / 3600
    print(f"{TILES} tiles x {SIDE - 1}^2 = {world:.4g} cells / {cells / all_cpu / 1e6:.2f} million a second = "
          f"{hours:.1f} core hours, if their voids are as those here")


if __name__ == "__main__":
    main()

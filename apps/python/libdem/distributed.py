"""Mosaics of any size on a Dask cluster.

    from dask.distributed import Client
    from libdem.distributed import fill_mosaic
    report = fill_mosaic("srtm/", "filled/", Client("scheduler:8786"), where="not at_border")

The mosaic is looked at part by part, holes are joined over the edges of parts and dealt out in bundles;
each bundle is one task that leaves its cells in a journal in the output folder, from which the tiles are
written. What is on disk is not done again, so that the same call goes on after any stop. Every tile is,
bit for bit, the part of what one `dem fill` of the whole mosaic gives.
"""

import contextlib
import dataclasses
import functools
import hashlib
import json
import os
import pathlib
import pickle
import shutil
import statistics
import threading
import time
import xml.etree.ElementTree as xml

from . import _api, _core
from ._progress import callback

__all__ = ["fill_mosaic"]

FOLDER = ".libdem-fill"  #: of journals, in the output folder


# ---- The mosaic

@dataclasses.dataclass(frozen=True)
class _Tile:
    path: str
    box: tuple  # column, row, columns, rows in the mosaic


def _tile_files(sources):
    """The files that `sources` names, or one VRT."""
    if not isinstance(sources, (str, os.PathLike)):
        return [os.fspath(source) for source in sources]
    path = os.fspath(sources)
    return _core.tiles_in(path) if os.path.isdir(path) else [path]


def _tiles_of_vrt(path):
    """The tiles that a VRT is made of."""
    try:
        band = xml.parse(path).getroot().find("VRTRasterBand")
    except xml.ParseError as error:
        raise OSError(f"{path}: is no VRT: {error}") from None
    tiles = []
    for source in [] if band is None else band.iter():
        if source.tag not in ("SimpleSource", "ComplexSource"):
            continue
        name, of, to = (source.find(tag) for tag in ("SourceFilename", "SourceProperties", "DstRect"))
        file = name.text if name.get("relativeToVRT") != "1" else os.path.join(os.path.dirname(path), name.text)
        size = _core.describe(file)["size"] if of is None else (int(of.get("RasterXSize")), int(of.get("RasterYSize")))
        sides = ("xOff", "yOff", "xSize", "ySize")
        box = (0, 0, *size) if to is None else tuple(round(float(to.get(side))) for side in sides)
        if box[2:] != tuple(size):
            raise ValueError(f"{path}: shows {file} in {box[2]} x {box[3]} cells; it has {size[0]} x {size[1]}")
        tiles.append(_Tile(file, box))
    if not tiles:
        raise ValueError(f"{path}: is a VRT of no tiles")
    return tiles


def _place(head, first):
    """Column and row of a file in the lattice of the first one."""
    place = []
    for at, step in ((0, 1), (3, 5)):
        a, b = head["to_world"], first["to_world"]
        if abs(a[step] - b[step]) > 1e-6 * abs(b[step]):
            return None
        cells = (a[at] - b[at]) / b[step]
        if abs(cells - round(cells)) > 1e-3:
            return None
        place.append(round(cells))
    return place


def _write_vrt(files, heads, nodata, path):
    """A VRT of the files with these heads, which must lie on one lattice; their tiles."""
    first = heads[0]
    places = []
    for file, head in zip(files, heads):
        for what in "type", "crs":
            if head[what] != first[what]:
                raise ValueError(f"{file}: its {what} is {head[what][:60]}; must be {first[what][:60]}, "
                                 f"as in {files[0]}")
        place = _place(head, first)
        if place is None:
            raise ValueError(f"{file}: its cells do not lie on the lattice of those of {files[0]}")
        places.append(place)
    west, north = min(p[0] for p in places), min(p[1] for p in places)
    tiles = [_Tile(file, (p[0] - west, p[1] - north, *head["size"])) for file, p, head in zip(files, places, heads)]
    root = xml.Element("VRTDataset", rasterXSize=str(max(t.box[0] + t.box[2] for t in tiles)),
                       rasterYSize=str(max(t.box[1] + t.box[3] for t in tiles)))
    x, dx, _, y, _, dy = first["to_world"]
    if first["crs"]:
        axes = "2,1" if first["crs"].startswith("GEOGC") else "1,2"
        xml.SubElement(root, "SRS", dataAxisToSRSAxisMapping=axes).text = first["crs"]
    corner = (x + (west - 0.5) * dx, dx, 0, y + (north - 0.5) * dy, 0, dy)
    xml.SubElement(root, "GeoTransform").text = ", ".join(repr(float(v)) for v in corner)
    band = xml.SubElement(root, "VRTRasterBand", dataType=first["type"], band="1")
    unknown = nodata if nodata is not None else first["nodata"]
    if unknown is None:
        unknown = "nan" if first["type"].startswith("Float") else -32768
    xml.SubElement(band, "NoDataValue").text = str(unknown)
    for tile, head in zip(tiles, heads):
        source = xml.SubElement(band, "ComplexSource")
        xml.SubElement(source, "SourceFilename", relativeToVRT="0").text = os.path.abspath(tile.path)
        xml.SubElement(source, "SourceBand").text = "1"
        cols, rows = head["size"]
        xml.SubElement(source, "SourceProperties", RasterXSize=str(cols), RasterYSize=str(rows),
                       DataType=first["type"])
        for tag, place in (("SrcRect", (0, 0)), ("DstRect", tile.box[:2])):
            xml.SubElement(source, tag, xOff=str(place[0]), yOff=str(place[1]), xSize=str(cols), ySize=str(rows))
        own = nodata if nodata is not None else head["nodata"]
        if own is not None:
            xml.SubElement(source, "NODATA").text = str(own)
    _write_whole(path, xml.tostring(root))
    return tiles


def _parts(tiles, size):
    """Boxes of about a tile's size that cover the mosaic."""
    def step(axis):
        starts = sorted({tile.box[axis] for tile in tiles})
        gaps = [b - a for a, b in zip(starts, starts[1:])]
        side = statistics.mode(tile.box[axis + 2] for tile in tiles)
        return max(512, statistics.mode(gaps) if gaps else 0, min(4096, side) - 1)
    cols, rows = step(0), step(1)
    return [(col, row, min(cols, size[0] - col), min(rows, size[1] - row))
            for row in range(0, size[1], rows) for col in range(0, size[0], cols)]


# ---- Tasks: each leaves a file, and does nothing when it is there

@dataclasses.dataclass(frozen=True)
class _Job:
    """What all tasks share."""
    mosaic: str
    folder: str
    key: str
    nodata: object
    method: str
    settings: tuple
    choice: tuple
    whole: bool
    aux: tuple
    water: str
    memory: str
    threads: int

    def open(self):
        return _core.SharedFill(self.mosaic, self.nodata, self.method, list(self.settings),
                                _core.HoleChoice(*self.choice), self.whole, list(self.aux), self.water, self.memory)

    def check(self):
        """Tells of bad settings before any work."""
        _core.check_job(self.method, list(self.settings), _core.HoleChoice(*self.choice), self.memory)

    def file(self, kind, number):
        return os.path.join(self.folder, f"{kind}-{number:06d}")


_opened = threading.local()  # GDAL's files are for one thread


def _raster(job):
    if getattr(_opened, "job", None) != job:
        _opened.raster, _opened.job = job.open(), job
    return _opened.raster


def _write_whole(path, content):
    """A file that is there whole or not at all, whoever else writes it."""
    beside = f"{path}.{os.getpid()}.{threading.get_ident()}"
    try:
        with open(beside, "wb") as file:
            file.write(content)
        os.replace(beside, path)
    finally:
        with contextlib.suppress(FileNotFoundError):
            os.remove(beside)


def _timed(task):
    """A task that also tells the processor time of its own thread."""
    @functools.wraps(task)
    def timed(*arguments):
        begin = time.thread_time()
        result = task(*arguments)
        return result, time.thread_time() - begin
    return timed


@_timed
def read_heads(files):
    """Where tiles lie, and of what type they are."""
    return [_core.describe(file) for file in files]


@_timed
def scan_part(job, number, box):
    """Finds the holes of one part."""
    path = job.file("part", number)
    if not os.path.exists(path):
        _write_whole(path, _raster(job).scan(box))


@_timed
def fill_bundle(job, number, bundle):
    """Fills the holes of one bundle into its journal. A worker that was given up may still be at it, or a
    call that was stopped: then it is waited for."""
    end = time.monotonic() + 600
    while True:
        try:
            return _raster(job).fill(bundle, job.file("journal", number), job.key, job.threads, None)
        except OSError as error:
            if "another run is working with it" not in str(error) or time.monotonic() > end:
                raise
        time.sleep(0.2)


@_timed
def write_tile(job, number, tile, bundles, out, done):
    """Writes one tile; how many of its cells are unknown. `done`: what fill_bundle gave for the bundles,
    whose tasks are thus done before."""
    marker = job.file("tile", number)
    if not (os.path.exists(marker) and os.path.exists(out)):
        metadata = [("DEM_METHOD", job.method), ("DEM_SETTINGS", " ".join("=".join(s) for s in job.settings)),
                    ("DEM_VERSION", _core.version)]
        left = _raster(job).write_tile(tile.path, tile.box, [job.file("journal", b) for b in bundles], job.key, out,
                                       metadata)
        _write_whole(marker, str(left).encode())
    return int(pathlib.Path(marker).read_bytes())


# ---- The run

def _stamp(path):
    try:
        state = os.stat(path)
    except OSError as error:
        raise OSError(f"{path}: {error.strerror}") from None
    return [os.path.abspath(path), state.st_size, state.st_mtime_ns]


def _outputs(tiles, out_dir):
    """Where each tile goes."""
    names, outs = {}, []
    for tile in tiles:
        name = os.path.basename(tile.path)
        if name in names:
            raise ValueError(f"{tile.path}: has the name of {names[name]}; both cannot lie in {out_dir}")
        names[name] = tile.path
        if os.path.abspath(os.path.dirname(tile.path)) == os.path.abspath(out_dir):
            raise ValueError(f"out_dir = {out_dir}; must not be the folder of the source {tile.path}")
        outs.append(os.path.join(os.path.abspath(out_dir), name))
    return outs


def _prepare(job_key, folder, outs, overwrite):
    """An empty folder, or that of the same run; outputs of others are not replaced unasked."""
    key_file = os.path.join(folder, "key")
    if os.path.isdir(folder):
        same = os.path.exists(key_file) and pathlib.Path(key_file).read_text() == job_key
        if same:
            return
        if not overwrite:
            raise FileExistsError(f"{folder}: is of a run with other sources or settings; overwrite=True begins anew")
        shutil.rmtree(folder)
    if not overwrite:
        for out in outs:
            if os.path.exists(out):
                raise FileExistsError(f"{out}: exists; overwrite=True replaces it")
    os.makedirs(folder)
    _write_whole(key_file, job_key.encode())


@contextlib.contextmanager
def _client(client):
    from distributed import Client, LocalCluster
    if client is None:
        with contextlib.suppress(ValueError):
            client = Client.current()
    if client is not None:
        yield client
        return
    with LocalCluster(processes=True, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as own:
        yield own


class _Futures:
    """Tasks on a cluster; none goes on when the call ends early."""

    def __init__(self, cluster, retries):
        self._cluster, self._retries, self._all = cluster, retries, []

    def submit(self, function, *arguments):
        future = self._cluster.submit(function, *arguments, retries=self._retries, pure=False)
        self._all.append(future)
        return future

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        if kind is not None:
            self._cluster.cancel(self._all, force=True)


def _gather(futures, report, first, last, what):
    """Results in order; the first error is raised."""
    from distributed import as_completed
    from distributed.scheduler import KilledWorker
    for n, future in enumerate(as_completed(futures), 1):
        if future.status == "error":
            error = future.exception()
            if isinstance(error, KilledWorker):
                raise RuntimeError(f"{what}: workers died again and again at {future.key}; what is done is kept, the "
                                   "same call goes on from there (fewer threads per worker need less memory)") from None
            raise error
        if report:
            report(first + (last - first) * n / len(futures), what)
    results = [future.result() for future in futures]
    return [result for result, _ in results], sum(seconds for _, seconds in results)


def fill_mosaic(sources, out_dir, client=None, *, method=_core.default_method, nodata=None, inner_only=False,
                max_area_km2=None, max_distance_m=None, min_cells=None, where="", whole=False, aux=(), water="",
                memory="1G", threads=1, bundle_cells=1_000_000, retries=2, overwrite=False, progress=None, **settings):
    """Fills the holes of a mosaic on a Dask cluster and writes its tiles to a folder.

    sources   a list of files on one lattice, a VRT of them, or a folder of .hgt (or .tif) tiles. All
              workers must see them, and out_dir, under the same names.
    out_dir   gets a file like each source; where tiles overlap (the shared edges of .hgt), all get the
              value that the mosaic shows. Holes are also the gaps between tiles: where="not at_border"
              or inner_only=True leaves the sea.
    client    of a Dask cluster; None: the current one, or processes on this machine for the time of the call
    nodata    the value that means unknown; by default what the files declare (undeclared ones are not
              looked for)
    method, where ..., aux, water, settings: as `libdem.fill`
    memory    of one task; a worker runs as many at once as it has threads. A hole that needs more is an
              error before anything is filled
    threads   of one task
    bundle_cells   so many cells of windows to one task, at least
    retries   of a task that fails; workers that die are Dask's business, and their tasks go elsewhere
    overwrite replace what is in out_dir

    The same call goes on where another was stopped; a finished run leaves tiles only. Returns a dict:
    tiles, cells, unknown, voids, filled, left, windows, seconds of each step, cpu_seconds of its tasks (of
    their own threads, and of this run alone) ...
    Steps on Dask's dashboard: scan_part, fill_bundle, write_tile.
    """
    begin = time.monotonic()
    files = _tile_files(sources)
    if not files:
        raise ValueError("sources is empty; at least one file is needed")
    given_vrt = files[0] if len(files) == 1 and files[0].lower().endswith(".vrt") else None
    stamps = [_stamp(file) for file in files]
    if given_vrt:
        files = [tile.path for tile in _tiles_of_vrt(given_vrt)]
        stamps += [_stamp(file) for file in files]
    outs = _outputs([_Tile(file, ()) for file in files], out_dir)
    text = _api._method_settings(method, settings)
    choice = (inner_only, max_area_km2, max_distance_m, min_cells, where)
    aux = tuple(os.path.abspath(file) for file in ([aux] if isinstance(aux, (str, os.PathLike)) else aux))
    water = os.path.abspath(water) if water else ""
    told = [_core.version, stamps, nodata, method, text, choice, whole, aux, water, str(memory), bundle_cells]
    key = hashlib.sha256(json.dumps(told).encode()).hexdigest()
    folder = os.path.join(os.path.abspath(out_dir), FOLDER)
    mosaic = os.path.abspath(given_vrt) if given_vrt else os.path.join(folder, "mosaic.vrt")
    job = _Job(mosaic, folder, key, nodata, method, tuple(text), choice, whole, aux, water, str(memory), threads)
    job.check()
    _prepare(key, folder, outs, overwrite)
    with callback(progress) as report, _client(client) as cluster, _Futures(cluster, retries) as tasks:
        result = _run(job, files, outs, bundle_cells, tasks, report)
    result["seconds"]["all"] = time.monotonic() - begin
    shutil.rmtree(folder)
    return result


def _run(job, files, outs, bundle_cells, tasks, report):
    """The steps of a run, each on the cluster; what was done."""
    cpu, seconds = {}, [time.monotonic()]
    if not os.path.exists(job.mosaic):
        cpu["heads"] = _make_vrt(job, files, tasks, report)
    tiles = _tiles_of_vrt(job.mosaic)
    raster = job.open()
    (bundles, told), cpu["scan"] = _plan(job, raster, tiles, tasks, report, bundle_cells)
    seconds.append(time.monotonic())
    filling = [tasks.submit(fill_bundle, job, n, bundle) for n, (bundle, _, _) in enumerate(bundles)]
    bundles_of = [[] for _ in tiles]
    for n, (_, _, numbers) in enumerate(bundles):
        for tile in numbers:
            bundles_of[tile].append(n)
    writing = [tasks.submit(write_tile, job, t, tile, bundles_of[t], out, [filling[n] for n in bundles_of[t]])
               for t, (tile, out) in enumerate(zip(tiles, outs))]
    filled, cpu["fill"] = _gather(filling, report, 0.2, 0.8, "filling holes")
    seconds.append(time.monotonic())
    left, cpu["write"] = _gather(writing, report, 0.8, 1, "writing tiles")
    seconds.append(time.monotonic())
    result = {"tiles": len(tiles), "cells": raster.size[0] * raster.size[1], **told, "bundles": len(bundles)}
    for name in "filled", "left", "water", "over_aux", "windows", "resumed":
        result[name] = sum(outcome[name] for outcome in filled)
    result["unknown_in_tiles"] = sum(left)
    result["seconds"] = {name: b - a for name, a, b in zip(("scan", "fill", "write"), seconds, seconds[1:])}
    result["cpu_seconds"] = cpu
    return result


def _make_vrt(job, files, tasks, report):
    """Writes the VRT of the mosaic; the processor time of reading heads."""
    some = 16
    reading = [tasks.submit(read_heads, files[n:n + some]) for n in range(0, len(files), some)]
    heads, cpu = _gather(reading, report, 0, 0.02, "reading heads")
    _write_vrt(files, [head for some in heads for head in some], job.nodata, job.mosaic)
    return cpu


def _plan(job, raster, tiles, tasks, report, bundle_cells):
    """Bundles with the tiles they touch, and the processor time of scanning; from disk when made before."""
    path = os.path.join(job.folder, "plan")
    if os.path.exists(path):
        return pickle.loads(pathlib.Path(path).read_bytes()), 0.0
    boxes = _parts(tiles, raster.size)
    scanning = [tasks.submit(scan_part, job, n, box) for n, box in enumerate(boxes)]
    try:
        _, cpu = _gather(scanning, report, 0.02, 0.19, "looking for holes")
    except OSError:  # GDAL names the mosaic; name the tile
        for future, box in zip(scanning, boxes):
            if future.status == "error":
                for tile in tiles:
                    if _overlap(tile.box, box):
                        _api.read(tile.path)
        raise
    parts = [pathlib.Path(job.file("part", n)).read_bytes() for n in range(len(boxes))]
    plan = raster.plan(parts, [tile.box for tile in tiles], bundle_cells, report and functools.partial(_scaled, report))
    _write_whole(path, pickle.dumps(plan))
    return plan, cpu


def _overlap(a, b):
    return all(a[i] < b[i] + b[i + 2] and b[i] < a[i] + a[i + 2] for i in (0, 1))


def _scaled(report, part, what):
    return report(0.19 + 0.01 * part, what)

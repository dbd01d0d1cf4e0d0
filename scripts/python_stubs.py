#!/usr/bin/env python3
"""Writes the type stubs of the package from the package itself: signatures by inspection, settings from
the tables of methods, so that neither is listed twice.

    python_stubs.py OUT.pyi
"""
import inspect
import keyword
import sys

import libdem
from libdem import _tables

# What the parameters are, by name.
TYPES = {
    "z": "Heights", "truth": "Heights", "got": "Heights", "like": "Heights | None", "sampled": "Heights | None",
    "known": "npt.ArrayLike | None",
    "x": "npt.ArrayLike | Path | None", "y": "npt.ArrayLike | None", "method": "str", "name": "str",
    "spacing": "float | tuple[float, float] | None", "nodata": "float | None", "to_world": "Sequence[float] | None",
    "crs": "str", "inner_only": "bool", "max_area_km2": "float | None", "max_distance_m": "float | None",
    "min_cells": "int | None", "where": "str", "region": "Path", "whole": "bool", "aux": "Path | Sequence[Path]",
    "water": "Path", "report_holes": "bool", "threads": "int", "progress": "Progress", "factor": "float",
    "nodes": "bool | None",
    "bounds": "tuple[float, float, float, float] | None", "cell": "str | float",
    "sigma": "npt.ArrayLike | None", "point_sigma": "npt.ArrayLike | None", "point_weight": "npt.ArrayLike | None",
    "contours": "Path | Sequence[tuple[float, npt.ArrayLike]] | None",
    "breaklines": "Path | Sequence[npt.ArrayLike] | None", "to_crs": "str", "x_field": "str", "y_field": "str",
    "z_field": "str", "sigma_field": "str", "weight_field": "str", "position_field": "str",
    "delimiter": "str | None", "layer": "str", "classes": "Sequence[int]", "no_fill": "bool",
    "reject_outliers": "float", "snap": "bool", "passes": "int",
    "keep": "float | None", "count": "int | None", "every": "int | None", "edges": "float | None",
    "voids": "float | None", "tracks": "int | None", "contours_m": "float | None", "greedy": "int | None",
    "max_error_m": "float | None", "seed": "int", "shape": "int | tuple[int, int] | None",
    "origin": "tuple[float, float]", "image": "npt.ArrayLike | Path | None", "median": "int", "style": "str",
    "camera": "Sequence[float | str] | None", "target": "Sequence[float | str] | None", "path": "Path", "band": "int",
    "detect_nodata": "bool", "tile": "str", "height_range": "tuple[float, float] | None", "format": "str",
    "dtype": "npt.DTypeLike", "compress": "bool", "overwrite": "bool", "metadata": "Mapping[str, str] | None",
}
RETURNS = {"fill": "Filled", "supersample": "Filled", "grid": "Filled", "sample": "Dem", "generate": "Dem",
           "erode": "Eroded", "evaluate": "Scores", "render": "npt.NDArray[np.uint8]", "read": "Dem", "write": "None"}
PROPERTIES = {"z": "npt.NDArray[np.float32]", "known": "npt.NDArray[np.bool_]",
              "elevation": "npt.NDArray[np.floating[Any]]", "shape": "tuple[int, int]",
              "spacing": "tuple[float, float]", "to_world": "list[float]", "crs": "str", "dtype": "str",
              "nodata": "float | None"}
# Parameters that choose one of the names of a field: (options, field).
CHOICES = {"preserve": ("supersample", "preserve"), "combine": ("bin", "combine")}
KINDS = {"number": "float", "integer": "int", "boolean": "bool"}

HEAD = '''\
# Written by scripts/python_stubs.py from the package's tables.
import dataclasses
import enum
import os
import types
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, overload

import numpy as np
import numpy.typing as npt

Path = str | os.PathLike[str]
Heights = npt.ArrayLike | Dem | Filled | Eroded | Any  # Any: an xarray DataArray
Progress = bool | Callable[[float, str], bool | None] | Any | None  # Any: a tqdm bar

__version__: str
'''


def type_of(field):
    if field.type in KINDS:
        return KINDS[field.type]
    if field.type == "text":
        return "str"
    choices = f"Literal[{', '.join(repr(choice) for choice in field.choices)}]"
    return f"bool | {choices}" if field.name == "sigma" else choices


def chosen_type(name):
    options, field = CHOICES[name]
    return type_of(next(f for f in _tables.option_fields()[options] if f.name == field))


def parameter(p):
    text = f"{p.name}: {TYPES[p.name] if p.name in TYPES else chosen_type(p.name)}"
    return text if p.default is inspect.Parameter.empty else f"{text} = {p.default!r}"


def settings(fields, taken):
    return [f"{f.name}: {type_of(f)} = {f.default!r}" for f in fields
            if f.name not in taken and f.name.isidentifier() and not keyword.iskeyword(f.name)]


def function(name, replaced=None, fields=(), decorator=""):
    """One signature; `replaced`: a parameter's name, and the type it has in this overload."""
    parameters = [p for p in inspect.signature(getattr(libdem, name)).parameters.values()
                  if p.kind is not inspect.Parameter.VAR_KEYWORD]
    texts, star = [], False
    for p in parameters:
        if p.kind is inspect.Parameter.KEYWORD_ONLY and not star:
            texts.append("*")
            star = True
        if replaced and p.name == replaced[0]:
            optional = replaced[2] and p.default is not inspect.Parameter.empty
            texts.append(f"{p.name}: {replaced[1]}" + (" = ..." if optional else ""))
        else:
            texts.append(parameter(p))
    texts += settings(fields, {p.name for p in parameters})
    return f"{decorator}def {name}({', '.join(texts)}) -> {RETURNS[name]}: ...\n"


def literal(row):
    names = [row.name] + [f"{row.name}:{preset.name}" for preset in row.presets]
    return f"Literal[{', '.join(repr(n) for n in names)}]"


def overloads(name, parameter_name, rows, default):
    """The default's signature comes first: only it may leave the parameter out. The last one is for names
    that are not known before the program runs."""
    rows = sorted(rows, key=lambda row: row[1] != default)
    any_name = function(name, (parameter_name, "str", False), (), "@overload\n")
    any_name = any_name.replace(") ->", ", **settings: Any) ->")
    return "".join(function(name, (parameter_name, text, row_name == default), fields, "@overload\n")
                   for text, row_name, fields in rows) + any_name


def of_class(cls):
    lines = [f"class {cls.__name__}:"]
    for name, value in sorted(vars(cls).items()):
        if isinstance(value, property) and not name.startswith("_"):
            kind = PROPERTIES.get(name, "Any")
            lines.append(f"    @property\n    def {name}(self) -> {kind}: ...")
    return lines


def stubs():
    methods = [(literal(m), m.name, m.fields) for m in libdem.methods().values()]
    generators = [(literal(g), g.name, g.fields) for g in libdem.generators().values()]
    styles = [(f"Literal[{s!r}]", s, fields) for s, fields in libdem.style_fields().items()]
    default = inspect.signature(libdem.fill).parameters["method"].default
    out = [HEAD, "class CellOrigin(enum.IntEnum):"]
    out += [f"    {origin.name} = {origin.value}" for origin in libdem.CellOrigin]
    out += of_class(libdem.Dem)
    out.append("    def __init__(self, z: npt.ArrayLike, known: npt.ArrayLike | None = None, "
               "nodata: float | None = None, spacing: tuple[float, float] | None = None, "
               "to_world: Sequence[float] | None = None, crs: str = '') -> None: ...")
    for cls in libdem.Filled, libdem.Eroded, libdem.Field, libdem.Preset, libdem.Method:
        out += ["@dataclasses.dataclass(frozen=True)"] + of_class(cls)
        annotations = {"dem": "Dem", "report": "dict[str, Any]", "fields": "tuple[Field, ...]",
                       "presets": "tuple[Preset, ...]"}
        for name, kind in cls.__annotations__.items():
            kind = annotations.get(name, kind if isinstance(kind, str) else
                                   "Any" if kind is object else kind.__name__)
            out.append(f"    {name}: {kind}")
    out += ["class Scores(types.SimpleNamespace):", "    all: Any", "    filled: Any", "    unfilled_cells: int",
            "    calibration: Any", "    spectrum: Any", "class ProgressBar:",
            "    def __init__(self, bar: Any = None, **options: Any) -> None: ...",
            "    def __call__(self, part: float, what: str) -> None: ...", "    def close(self) -> None: ...",
            "    def __enter__(self) -> ProgressBar: ...", "    def __exit__(self, *_: Any) -> None: ...",
            "def methods() -> dict[str, Method]: ...", "def generators() -> dict[str, Method]: ...",
            "def erosion_fields() -> tuple[Field, ...]: ...",
            "def style_fields() -> dict[str, tuple[Field, ...]]: ..."]
    out += [overloads(name, "method", methods, default) for name in ("fill", "supersample", "grid")]
    out += [overloads("generate", "name", generators, None), overloads("render", "style", styles, "relief"),
            function("erode", fields=libdem.erosion_fields())]
    out += [function(name) for name in ("sample", "evaluate", "read", "write")]
    return "\n".join(out)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with open(sys.argv[1], "w", encoding="utf-8") as file:
        file.write(stubs())


if __name__ == "__main__":
    main()

"""The library's tables of methods, generators and their fields; nothing is listed twice."""

import dataclasses
import numbers
import textwrap

import numpy as np

from . import _core


@dataclasses.dataclass(frozen=True)
class Field:
    """A setting: its default is `default`, its range `range` as text ("[0, 1]", "a | b")."""
    name: str
    type: str
    unit: str
    range: str
    default: object
    choices: tuple
    doc: str

    def __str__(self):
        unit = f" {self.unit}" if self.unit else ""
        kind = ", ".join(filter(None, [self.type, self.range]))
        return f"{self.name} = {self.default!r}{unit}  ({kind})\n    {self.doc}"


@dataclasses.dataclass(frozen=True)
class Preset:
    """A named group of settings, chosen as "method:preset"."""
    name: str
    doc: str
    settings: dict


@dataclasses.dataclass(frozen=True)
class Method:
    """A fill method or generator: str() of it lists its settings."""
    name: str
    summary: str
    citation: str
    fields: tuple
    presets: tuple
    image: str = ""
    globe: bool = False
    bytes_per_cell: int = 0  #: memory that a fill method needs; 0 for generators

    def __str__(self):
        lines = [f"{self.name}: {self.summary}" + (f" [{self.citation}]" if self.citation else "")]
        if self.image:
            lines.append(f"starts from an image: {self.image}")
        lines += [textwrap.indent(str(f), "    ") for f in self.fields]
        lines += [f"    preset {self.name}:{p.name}: {p.doc}" for p in self.presets]
        return "\n".join(lines)


def _value(kind, text):
    """The value that a default's text stands for; None for one that is not set."""
    if not text and kind != "text":
        return None
    return {"number": float, "integer": int, "boolean": "true".__eq__}.get(kind, str)(text)


def _fields(rows):
    return tuple(Field(r["name"], r["type"], r["unit"], r["range"], _value(r["type"], r["default"]),
                       tuple(r["choices"]), r["doc"]) for r in rows)


def _method(row):
    presets = tuple(Preset(p["name"], p["doc"], dict(p["settings"])) for p in row["presets"])
    return Method(row["name"], row["summary"], row["citation"], _fields(row["fields"]), presets,
                  row.get("image", ""), row.get("globe", False), row.get("bytes_per_cell", 0))


def methods():
    """The fill methods, as a dict from name to Method."""
    return {row["name"]: _method(row) for row in _core.methods()}


def generators():
    """The terrain generators, as a dict from name to Method."""
    return {row["name"]: _method(row) for row in _core.generators()}


def option_fields():
    """The fields of options that are not a method's, as a dict: bin, gridding, supersample, write."""
    return {name: _fields(rows) for name, rows in _core.option_fields().items()}


def erosion_fields():
    """The settings of `erode`."""
    return _fields(_core.erosion_fields())


def style_fields():
    """The settings of `render`, as a dict from style to fields."""
    return {style: _fields(rows) for style, rows in _core.style_fields().items()}


def as_settings(keywords):
    """Settings as the library takes them, from keywords."""
    return [(name, _text(name, value)) for name, value in keywords.items()]


def _text(name, value):
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        return repr(float(value))
    if isinstance(value, str):
        return value
    raise ValueError(f"{name} = {value!r}; must be a number, a string or a boolean")


def settings_doc(title, rows):
    """A part of a docstring: what the keywords of a function are."""
    body = "\n\n".join(str(row) for row in rows)
    return f"{title}\n" + textwrap.indent(body, "    ")

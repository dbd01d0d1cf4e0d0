"""From the options of a verb, as the program lists them, to parameters of Processing, and from their values back to
arguments. Each maker below returns (parameter, reader): the reader turns the parameter's value into text, or a list of
texts, or None when it is not set."""

import re

from qgis.core import (QgsProcessing, QgsProcessingParameterBoolean, QgsProcessingParameterCrs,
                       QgsProcessingParameterDefinition, QgsProcessingParameterEnum,
                       QgsProcessingParameterFileDestination, QgsProcessingParameterFolderDestination,
                       QgsProcessingParameterMapLayer, QgsProcessingParameterMultipleLayers,
                       QgsProcessingParameterNumber, QgsProcessingParameterRasterDestination,
                       QgsProcessingParameterRasterLayer, QgsProcessingParameterString,
                       QgsProcessingParameterVectorDestination, QgsProcessingParameterVectorLayer)

VECTOR_FORMATS = ["gpkg", "shp", "geojson", "json", "csv", "gml", "kml", "tab", "sqlite"]


class Call:
    """One run of an algorithm: what its values are read from."""

    def __init__(self, algorithm, values, context, feedback):
        self.algorithm, self.values, self.context, self.feedback = algorithm, values, context, feedback

    def is_set(self, name):
        return self.values.get(name) not in (None, "")

    def __getattr__(self, reader):
        """parameterAs...: call.parameterAsString(name)."""
        method = getattr(self.algorithm, reader)
        return lambda name, *more: method(self.values, name, self.context, *more)


def label(name, doc):
    words = name.replace("-", " ").replace("_", " ")
    return f"{words[:1].upper()}{words[1:]}: {doc}"


def number_text(value):
    return str(int(value)) if float(value).is_integer() else repr(float(value))


def raster(name, title, optional):
    def read(call):
        layer = call.parameterAsRasterLayer(name)
        return layer.source() if layer else None

    return QgsProcessingParameterRasterLayer(name, title, optional=optional), read


def rasters(name, title, optional):
    def read(call):
        return [layer.source() for layer in call.parameterAsLayerList(name)]

    return QgsProcessingParameterMultipleLayers(name, title, QgsProcessing.TypeRaster, optional=optional), read


def vector_path(call, name):
    """A file of the layer; one is written for layers that have none."""
    return call.parameterAsCompatibleSourceLayerPathAndLayerName(name, VECTOR_FORMATS, "gpkg", call.feedback)


def vector(name, title, optional):
    return (QgsProcessingParameterVectorLayer(name, title, optional=optional),
            lambda call: vector_path(call, name)[0] if call.is_set(name) else None)


def picture(name, title, optional):
    def read(call):
        layer = call.parameterAsLayer(name)
        return layer.source().split("|")[0] if layer else None

    kinds = [QgsProcessing.TypeRaster, QgsProcessing.TypeVectorAnyGeometry]
    return QgsProcessingParameterMapLayer(name, title, optional=optional, types=kinds), read


def new_raster(name, title, optional):
    return (QgsProcessingParameterRasterDestination(name, title, optional=optional, createByDefault=not optional),
            lambda call: call.parameterAsOutputLayer(name) or None)


def new_vector(name, title, optional):
    return (QgsProcessingParameterVectorDestination(name, title, optional=optional),
            lambda call: call.parameterAsOutputLayer(name) or None)


def new_file(name, title, optional):
    return (QgsProcessingParameterFileDestination(name, title, optional=optional, createByDefault=not optional),
            lambda call: call.parameterAsFileOutput(name) or None)


def new_folder(name, title, optional):
    return (QgsProcessingParameterFolderDestination(name, title, optional=optional, createByDefault=not optional),
            lambda call: call.parameterAsString(name) or None if call.is_set(name) else None)


def text(name, title, optional):
    return (QgsProcessingParameterString(name, title, optional=optional),
            lambda call: call.parameterAsString(name) or None)


def number(name, title, optional, low=None, high=None, whole=False):
    kind = QgsProcessingParameterNumber.Integer if whole else QgsProcessingParameterNumber.Double
    bounds = {key: value for key, value in (("minValue", low), ("maxValue", high)) if value is not None}
    if whole and bounds.get("maxValue", 0) > 2 ** 31 - 1:
        del bounds["maxValue"]
    return (QgsProcessingParameterNumber(name, title, kind, optional=optional, **bounds),
            lambda call: number_text(call.parameterAsDouble(name)) if call.is_set(name) else None)


def choice(name, title, optional, names):
    return (QgsProcessingParameterEnum(name, title, names, optional=optional, usesStaticStrings=True),
            lambda call: call.parameterAsEnumString(name) if call.is_set(name) else None)


def crs(name, title, optional):
    def read(call):
        if not call.is_set(name):
            return None
        system = call.parameterAsCrs(name)
        return system.authid() or system.toWkt()

    return QgsProcessingParameterCrs(name, title, optional=optional), read


def switch(name, title):
    return (QgsProcessingParameterBoolean(name, title, defaultValue=False),
            lambda call: call.parameterAsBool(name))


KINDS = {"raster": raster, "vector": vector, "points": vector, "new raster": new_raster, "new picture": new_raster,
         "new vector": new_vector, "new file": new_file, "new folder": new_folder, "number": number, "crs": crs}


def of_option(name, option, doc=None):
    """The parameter for an option of a verb, or for an argument by position."""
    positional = not option["names"][0].startswith("-")
    title = doc or option["doc"]
    title = title[:1].upper() + title[1:] if positional else label(option["names"][-1].lstrip("-"), title)
    if option["default"]:
        title += f" [{option['default']}]"
    if not positional and not option["value"]:
        return switch(name, title)
    optional = not option["required"]
    if option["choices"]:
        return choice(name, title, optional, option["choices"])
    if option["takes"] == "raster" and option["repeats"] and not positional:
        return rasters(name, title, optional)
    kind = option["takes"] or ("number" if option["value"] == "N" else "")
    return KINDS.get(kind, text)(name, title, optional)


def of_field(name, field, method=""):
    """The parameter for a setting. It has no value of its own: what is not set is left to the program."""
    title = label(f"{method} {field['name']}".strip(), field["doc"])
    title += f" [{field['default']}{' ' + field['unit'] if field['unit'] else ''}]"
    if field["choices"]:
        return choice(name, title, True, field["choices"])
    if field["type"] == "text":
        return text(name, title, True)
    between = re.fullmatch(r"[\[(](.+), (.+)\]", field["range"])
    above = re.fullmatch(r">=? (.+)", field["range"])
    low, high = map(float, between.groups()) if between else (float(above[1]) if above else None, None)
    return number(name, title, True, low, high, whole=field["type"] == "integer")


def advanced(parameter):
    parameter.setFlags(parameter.flags() | QgsProcessingParameterDefinition.FlagAdvanced)
    return parameter

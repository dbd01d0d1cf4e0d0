"""The algorithms: each is a verb of `dem`, with parameters that the program itself lists."""

import os

from osgeo import gdal
from qgis.core import (QgsProcessingAlgorithm, QgsProcessingException, QgsProcessingLayerPostProcessorInterface,
                       QgsProcessingOutputNumber, QgsProcessingParameterFile)

from . import parameters, tool

STYLES = os.path.join(os.path.dirname(__file__), "styles")

# Names that other algorithms of Processing have for the same things, and those that need one of their own.
NAMES = {"IN": "INPUT", "FILE": "INPUT", "OUT": "OUTPUT", "FILES": "OUTPUT"}

# Numbers that a model can go on with, by verb; the others are reported, too.
NUMBERS = {"info": ["unknown_cells", "voids", "largest_void_cells", "low_m", "high_m"],
           "fill": ["unknown", "filled", "left"],
           "evaluate": ["cells", "rmse_m", "mae_m", "bias_m", "nmad_m", "le90_m", "max_m", "slope_rmse_deg"]}

HIDDEN = {"--json", "--quiet", "--progress", "--overwrite", "--set", "--style"}


class Task:
    """What one algorithm does: a verb, and what of its command line is already decided."""

    def __init__(self, verb, name, title, group="", style="", generator=None):
        self.verb, self.name, self.title, self.group = verb, name, title, group
        self.style, self.generator = style, generator
        self.tables = None

    def offers(self, option):
        """Whether an option of the verb is one of the algorithm's."""
        name = option["names"][-1]
        if name in HIDDEN or self.generator and name == "--seed":  # --seed is a setting of generators
            return False
        if self.style and option["group"] in ("All styles", "Maps", "Views"):
            return name[2:].removeprefix("no-") in [f["name"] for f in self.tables["styles"][self.style]]
        return True

    def settings(self):
        """(method, field) of what --set takes."""
        if self.generator:
            return [("", field) for field in self.generator["fields"]]
        if self.verb == "erode":
            return [("", field) for field in self.tables["erosion"]]
        if self.verb in ("fill", "grid", "supersample"):
            return [(method["name"], field) for method in self.tables["fill"] for field in method["fields"]]
        return []


def tasks(tables):
    """The algorithms, from the program's tables; without them, the same but for the list of generators."""
    made = [Task("info", "inspect_voids", "Inspect voids"), Task("fill", "fill_voids", "Fill voids"),
            Task("grid", "grid_points", "Grid points"), Task("supersample", "supersample", "Supersample"),
            Task("evaluate", "evaluate", "Evaluate"), Task("erode", "erode", "Erode"),
            Task("render", "hillshade", "Hillshade", style="hillshade")]
    for generator in tables["generators"] if tables else [None]:
        name = generator["name"] if generator else ""
        made.append(Task("generate", f"generate_{name}".strip("_"), f"Generate {name.replace('_', ' ')}".strip(),
                         "Generate", generator=generator))
    for task in made:
        task.tables = tables
    return made


class Styled(QgsProcessingLayerPostProcessorInterface):
    """Gives a layer its style once it is loaded."""

    kept = []  # QGIS does not own them

    def __init__(self, name):
        super().__init__()
        self.style = os.path.join(STYLES, f"{name}.qml")
        Styled.kept.append(self)

    def postProcessLayer(self, layer, context, feedback):
        layer.loadNamedStyle(self.style)
        layer.triggerRepaint()


class DemAlgorithm(QgsProcessingAlgorithm):
    def __init__(self, task, program):
        super().__init__()
        self.task, self.program = task, program
        self.options, self.fields = [], []  # (name, table's entry, reader)

    def createInstance(self):
        return DemAlgorithm(self.task, self.program)

    def name(self):
        return self.task.name

    def displayName(self):
        return self.task.title

    def group(self):
        return self.task.group

    def groupId(self):
        return self.task.group.lower()

    def shortHelpString(self):
        if not self.task.tables:
            return ""
        text = self.task.tables["verbs"][self.task.verb]["summary"] + "."
        if self.task.generator:
            text += f"\n\n{self.task.title}: {self.task.generator['summary']}."
        elif any(method for method, _ in self.task.settings()):
            text += "\n\nMethods:" + "".join(f"\n{m['name']}: {m['summary']}" for m in self.task.tables["fill"])
        return text + ("\n\nWhat is not set is left to the program; its defaults stand in brackets. "
                       f"The command line is `dem {self.task.verb}`.")

    def canExecute(self):
        try:
            tool.tables(self.program())
        except tool.DemError as error:
            return False, str(error)
        return bool(self.task.tables), "dem is there now: open the algorithm again"

    # ---- Parameters

    def initAlgorithm(self, configuration=None):
        if not self.task.tables:
            return
        verb = self.task.tables["verbs"][self.task.verb]
        for argument in verb["arguments"]:
            if argument["names"] != ["NAME"]:
                self.add_argument(argument)
        for option in filter(self.task.offers, verb["options"]):
            made = self.add(self.options, option["names"][-1][2:], option, parameters.of_option)
            if option["group"] != "Options" and not option["takes"].startswith("new"):
                parameters.advanced(made)
        self.add_settings()
        for number in NUMBERS.get(self.task.verb, []):
            self.addOutput(QgsProcessingOutputNumber(number.upper(), number.replace("_", " ")))

    def add(self, where, words, entry, make, *more):
        name = words.replace("-", "_").upper()
        parameter, read = make(name, entry, *more)
        self.addParameter(parameter)
        where.append((name, entry, read))
        return parameter

    def add_argument(self, argument):
        name = NAMES.get(argument["names"][0], argument["names"][0])
        if argument["names"] == ["FILES"] and self.task.generator["image"]:
            title = parameters.label("image", self.task.generator["image"])
            parameter, self.image = parameters.picture("IMAGE", title, False)
            self.addParameter(parameter)
        if argument["takes"] != "points":
            self.add(self.options, name, {**argument, "doc": argument["doc"].split(":")[-1].strip()
                                          if argument["names"] == ["FILES"] else argument["doc"]}, parameters.of_option)
            return
        self.add(self.options, name, {**argument, "required": False}, parameters.of_option,
                 "a layer of points or lines")
        self.addParameter(QgsProcessingParameterFile(
            "POINTS_FILE", "Points file: instead of a layer, CSV, XYZ, TSV or LAS", optional=True))

    def add_settings(self):
        if self.task.generator and self.task.generator["presets"]:
            names = [preset["name"] for preset in self.task.generator["presets"]]
            title = parameters.label("preset", "a named group of settings")
            self.addParameter(parameters.choice("PRESET", title, True, names)[0])
        for method, field in self.task.settings():
            made = self.add(self.fields, f"{method}_{field['name']}".strip("_"), {**field, "method": method},
                            parameters.of_field, method)
            if method:
                parameters.advanced(made)

    # ---- A run

    def processAlgorithm(self, values, context, feedback):
        call = parameters.Call(self, values, context, feedback)
        try:
            program = self.program()
            arguments, outputs = self.command(call)
            feedback.pushCommandInfo(" ".join(["dem", *(f'"{a}"' if " " in a else a for a in arguments)]))
            report = tool.run(program, arguments, message=feedback.pushInfo, cancelled=feedback.isCanceled,
                              progress=lambda part, what: show(feedback, part, what))
        except tool.Cancelled as stop:
            feedback.pushInfo(str(stop))
            return {}
        except tool.DemError as error:
            raise QgsProcessingException(str(error)) from error
        if report.pop("exit_code") == tool.UNFILLED:
            feedback.pushWarning("Cells were left unfilled.")
        feedback.setProgress(100)
        self.finish(call, outputs)
        return {**self.numbers(report), **outputs}

    def command(self, call):
        """The arguments, and the outputs that they name."""
        positional, options, outputs = [], [], {}
        for name, entry, read in self.options:
            value = read(call)
            if value in (None, False, "", []):
                continue
            if entry["takes"].startswith("new"):
                outputs[name] = value
            if not entry["names"][0].startswith("-"):
                positional.append(value)
            elif value is True:
                options.append(entry["names"][-1])
            else:
                for one in value if isinstance(value, list) else [value]:
                    options.append(f"{entry['names'][-1]}={one}")
        if self.task.verb == "grid":
            positional.insert(0, self.points(call, positional, options))
        if self.task.generator:
            preset = call.parameterAsEnumString("PRESET") if call.is_set("PRESET") else ""
            image = [self.image(call)] if self.task.generator["image"] else []
            positional = [f"{self.task.generator['name']}:{preset}".strip(":"), *image, *positional]
        style = ["--style", self.task.style] if self.task.style else []
        return [self.task.verb, *positional, *style, *options, *self.settings(call), "--overwrite"], outputs

    def points(self, call, positional, options):
        """Where the points are; takes the layer's path out of `positional`."""
        given = [name for name in ("POINTS", "POINTS_FILE") if call.is_set(name)]
        if len(given) != 1:
            raise tool.DemError("give either a layer of points or a points file")
        if given == ["POINTS_FILE"]:
            return call.parameterAsFile("POINTS_FILE")
        positional.pop(0)
        path, layer = parameters.vector_path(call, "POINTS")
        if layer and not any(option.startswith("--layer=") for option in options):
            options.append(f"--layer={layer}")
        return path

    def settings(self, call):
        """--set KEY=VALUE of the method that was chosen; one of another method is an error."""
        chosen = ""
        if self.task.verb in ("fill", "grid", "supersample"):
            default = next(method["name"] for method in self.task.tables["fill"] if method["default"])
            chosen = (call.parameterAsEnumString("METHOD") if call.is_set("METHOD") else default).split(":")[0]
        arguments = []
        for name, field, read in self.fields:
            value = read(call)
            if value is None:
                continue
            if field["method"] != chosen:
                raise tool.DemError(f"{field['method']} {field['name']} = {value}; the method is {chosen}")
            arguments += ["--set", f"{field['name']}={value}"]
        return arguments

    def finish(self, call, outputs):
        """Styles for layers of kinds, and a place for the hillshade."""
        for name, style in (("SOURCE", "source"), ("SIGMA", "sigma")):
            path = outputs.get(name)
            if path and call.context.willLoadLayerOnCompletion(path):
                call.context.layerToLoadOnCompletionDetails(path).setPostProcessor(Styled(style))
        if self.task.verb == "render":
            place(call.parameterAsRasterLayer("INPUT").source(), outputs["OUTPUT"])

    def numbers(self, report):
        """The numbers and texts of the report, by name."""
        if self.task.verb == "info":
            report = report["files"][0]
        if self.task.verb == "evaluate":
            report = {**report, **(report["filled"] or report["all"])}
        return {key.upper(): value for key, value in report.items()
                if isinstance(value, (int, float, str)) and key != "output"}


def show(feedback, part, what):
    feedback.setProgress(100 * part)
    feedback.setProgressText(what)


def place(dem, picture):
    """A picture has a pixel for each cell of the DEM: it lies where that lies."""
    of, to = gdal.Open(dem), gdal.Open(picture, gdal.GA_Update)
    if of and to:
        to.SetGeoTransform(of.GetGeoTransform())
        to.SetProjection(of.GetProjection())

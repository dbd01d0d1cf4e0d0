"""The provider "libdem" of the Processing toolbox."""

from processing.core.ProcessingConfig import ProcessingConfig, Setting, settingsWatcher
from qgis.core import QgsMessageLog, QgsProcessingProvider, Qgis

from . import algorithms, tool

SETTING = "LIBDEM_DEM_PATH"


def program():
    """The program `dem`; raises DemError with where to set it."""
    return tool.find((ProcessingConfig.getSetting(SETTING) or "").strip())


class Provider(QgsProcessingProvider):
    def id(self):
        return "dem"

    def name(self):
        return "libdem"

    def longName(self):
        return "libdem: elevation models"

    def load(self):
        ProcessingConfig.settingIcons[self.name()] = self.icon()
        ProcessingConfig.addSetting(Setting(self.name(), SETTING, "Path of dem (empty: the one on the path)", "",
                                            valuetype=Setting.FILE))
        ProcessingConfig.readSettings()
        settingsWatcher.settingsChanged.connect(self.refreshAlgorithms)
        self.refreshAlgorithms()
        return True

    def unload(self):
        settingsWatcher.settingsChanged.disconnect(self.refreshAlgorithms)
        ProcessingConfig.removeSetting(SETTING)

    def loadAlgorithms(self):
        try:
            tables = tool.tables(program())
        except tool.DemError as error:
            QgsMessageLog.logMessage(str(error), self.name(), Qgis.Warning)
            tables = None
        for task in algorithms.tasks(tables):
            self.addAlgorithm(algorithms.DemAlgorithm(task, program))

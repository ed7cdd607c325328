"""Runs the Cura script as Cura does: as a module of a package, beside a class `Script` that gives settings."""

import importlib
import json
import os
import shutil
import sys
import tempfile
import unittest

SCRIPT = os.path.join(os.path.dirname(__file__), "../../printing/slicers/cura/AerateAnnotate.py")
REPORT = {
    "schema": "aerate.hollow",
    "input": {"path": "/models/part.stl"},
    "voids": {"count": 12, "min_radius_mm": 1.5, "max_radius_mm": 3.5},
    "measured": {"wall_mm": 1.2},
    "volume": {"removed_mm3": 1000.25, "removed_percent": 12.5},
}
GCODE = [";FLAVOR:Marlin\n;TIME:857\n;Filament used: 0.25m\n", ";LAYER:0\nG1 X1 E1\n", ";LAYER:1\nG1 X2 E2\n"]


class CuraScript(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        scripts = os.path.join(self.folder.name, "plugin", "scripts")
        os.makedirs(scripts)
        shutil.copy(SCRIPT, scripts)
        for package in ("plugin", "plugin/scripts"):
            open(os.path.join(self.folder.name, package, "__init__.py"), "w").close()
        with open(os.path.join(self.folder.name, "plugin", "Script.py"), "w") as file:
            file.write(
                "class Script:\n    settings = {}\n"
                "    def getSettingValueByKey(self, key):\n        return self.settings[key]\n"
            )
        sys.path.insert(0, self.folder.name)
        self.addCleanup(sys.path.remove, self.folder.name)
        for name in [name for name in sys.modules if name.split(".")[0] == "plugin"]:
            del sys.modules[name]
        importlib.invalidate_caches()
        self.script = importlib.import_module("plugin.scripts.AerateAnnotate").AerateAnnotate()

    def run_with(self, report):
        path = os.path.join(self.folder.name, "report.json")
        with open(path, "w") as file:
            file.write(report)
        self.script.settings = {"report": path}
        return self.script.execute(list(GCODE))

    def test_settings_are_those_that_cura_reads(self):
        description = json.loads(self.script.getSettingDataString())
        self.assertEqual(description["key"], "AerateAnnotate")
        self.assertEqual(description["version"], 2)
        self.assertEqual(description["settings"]["report"]["type"], "str")

    def test_notes_the_report_and_changes_nothing_else(self):
        result = self.run_with(json.dumps(REPORT))
        self.assertEqual(result[1:], GCODE[1:])
        self.assertTrue(result[0].startswith(GCODE[0]))
        added = result[0][len(GCODE[0]) :].splitlines()
        self.assertTrue(all(line.startswith(";") for line in added))
        self.assertIn("; aerate_voids = 12, radius 1.500 to 3.500 mm", added)
        self.assertIn("; aerate_removed_mm3 = 1000.2 (12.50 %)", added)
        self.assertIn("; aerate_seconds = 857", added)

    def test_does_so_once(self):
        once = self.run_with(json.dumps(REPORT))
        self.assertEqual(self.script.execute(once), once)

    def test_without_a_report(self):
        self.script.settings = {"report": ""}
        self.assertIn("; aerate_filament = 0.25m\n", self.script.execute(list(GCODE))[0])

    def test_an_unusable_report_is_a_remark(self):
        for report in ("no json", "{}", "[]", json.dumps(dict(REPORT, schema="aerate.pack"))):
            result = self.run_with(report)
            self.assertIn("; aerate_remark = the report cannot be used", result[0])
            self.assertEqual(result[1:], GCODE[1:])
        self.script.settings = {"report": "/none.json"}
        self.assertIn("; aerate_remark", self.script.execute(list(GCODE))[0])

    def test_nothing_to_annotate(self):
        self.script.settings = {"report": ""}
        self.assertEqual(self.script.execute([]), [])


if __name__ == "__main__":
    unittest.main()

"""Post-processing script for Cura: notes in the G-code what aerate took out of the model.

Cura gives its scripts the G-code but no model, so hollowing happens before (`aerate hollow --json report.json`).
This script puts the figures of that report, and the slicer's own, into the G-code as comments; no other line
changes. Copy the file into the `scripts` folder of Cura's configuration folder (docs/slicers.md).
"""

import json
import os

from ..Script import Script

BEGIN = "; aerate = begin"
END = "; aerate = end"


def figures_of_gcode(header):
    """What Cura says of the print, from the comments at the beginning of the G-code."""
    names = {";TIME": "seconds", ";Filament used": "filament", ";Layer height": "layer_height"}
    found = []
    for line in header.splitlines():
        name, colon, value = line.partition(":")
        if colon and name in names:
            found.append("; aerate_%s = %s" % (names[name], value.strip()))
    return found


def figures_of_report(path):
    """The lines for a report of `aerate hollow --json`. Raises OSError, ValueError, KeyError or TypeError."""
    with open(path, encoding="utf-8") as file:
        report = json.load(file)
    if report["schema"] != "aerate.hollow":
        raise ValueError("is a report of another command (%s)" % report["schema"])
    lines = [
        "; aerate_model = %s" % os.path.basename(report["input"]["path"]),
        "; aerate_voids = %d, radius %.3f to %.3f mm"
        % (report["voids"]["count"], report["voids"]["min_radius_mm"], report["voids"]["max_radius_mm"]),
        "; aerate_wall_mm = %.3f" % report["measured"]["wall_mm"],
    ]
    if report["volume"]["removed_mm3"] is not None:
        lines.append(
            "; aerate_removed_mm3 = %.1f (%.2f %%)"
            % (report["volume"]["removed_mm3"], report["volume"]["removed_percent"])
        )
    return lines


class AerateAnnotate(Script):
    def getSettingDataString(self):
        return json.dumps(
            {
                "name": "Note what aerate removed",
                "key": "AerateAnnotate",
                "metadata": {},
                "version": 2,
                "settings": {
                    "report": {
                        "label": "Report",
                        "description": "The file that 'aerate hollow --json FILE' wrote for this model; "
                        "empty for Cura's own figures alone.",
                        "type": "str",
                        "default_value": "",
                    }
                },
            }
        )

    def execute(self, data):
        if not data or any(BEGIN in layer for layer in data):
            return data
        lines = figures_of_gcode(data[0])
        path = self.getSettingValueByKey("report")
        if path:
            try:
                lines += figures_of_report(os.path.expanduser(path))
            except (OSError, ValueError, KeyError, TypeError) as error:
                # A remark is better than a print that cannot be saved.
                lines.append("; aerate_remark = the report cannot be used: %s" % str(error).replace("\n", " "))
        header = data[0] if data[0].endswith("\n") else data[0] + "\n"
        return [header + "\n".join([BEGIN] + lines + [END]) + "\n"] + list(data[1:])

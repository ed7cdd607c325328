#!/usr/bin/env python3
"""Completions as a shell offers them: test_completions.py SHELL FOLDER PROGRAM, where FOLDER has what the build made of the program's
options. Exits with 77, which CTest takes for "skipped", where the shell is not installed."""
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
from completing import SHELLS, is_there  # noqa: E402

SHELL, COMPLETIONS, PROGRAM = sys.argv[1], Path(sys.argv[2]).resolve(), Path(sys.argv[3]).resolve()
COMMANDS = {"hollow", "pack", "inspect", "support", "slice", "hook", "batch", "studio"}


def options_in_help(*command):
    """The long names at the beginnings of lines of the help."""
    text = subprocess.run([PROGRAM, *command, "--help"], capture_output=True, text=True, check=True).stdout
    rows = re.findall(r"^  (-[-\w,{}]+)", text, re.M)
    return {name for row in rows for name in re.findall(r"--[a-z][-a-z]*", row)}


class Completions(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = folder = Path(cls.temporary.name).resolve()
        for name in ("bunny.stl", "my model.STL", "part.3mf", "notes.txt", "shot.png", "settings.ini", "print.gcode", "table.csv",
                     "sub/inner.stl", "texts/readme.txt"):
            (folder / name).parent.mkdir(exist_ok=True)
            (folder / name).touch()
        cls.shell = SHELLS[SHELL](COMPLETIONS, folder)

    @classmethod
    def tearDownClass(cls):
        cls.shell.close()
        cls.temporary.cleanup()

    def offered(self, line):
        return {word.rstrip("=") if word.startswith("-") and word.endswith("=") else word for word in self.shell.offered(line)}

    def files(self, line):
        return {word.rstrip("/") for word in self.offered(line)}

    def test_commands(self):
        self.assertEqual(self.offered("aerate "), COMMANDS)
        self.assertEqual(self.offered("aerate hol"), {"hollow"})
        self.assertEqual(self.offered("aerate s"), {"slice", "studio", "support"})
        self.assertEqual(self.offered("aerate --config settings.ini ba"), {"batch"})

    def test_every_option_of_every_command(self):
        self.assertEqual(self.offered("aerate --"), options_in_help())
        for command in sorted(COMMANDS):
            with self.subTest(command):
                self.assertEqual(self.offered(f"aerate {command} --"), options_in_help(command) | {"--config"})
        self.assertEqual(self.offered("aerate hollow bunny.stl -o x.stl --picture-c"), {"--picture-cut", "--picture-colour"})

    def test_values(self):
        processes = {"fdm", "sla", "sls", "metal", "list"}
        for command in ("hollow", "pack", "inspect", "support", "slice", "hook", "batch"):
            with self.subTest(command):
                self.assertEqual(self.offered(f"aerate {command} --process "), processes)
        self.assertEqual(self.offered("aerate hollow --process sl"), {"sla", "sls"})
        self.assertEqual(self.offered("aerate hollow bunny.stl --shape "), {"spheres", "cells"})
        self.assertEqual(self.offered("aerate pack --device c"), {"cpu", "cuda"})
        self.assertEqual(self.offered("aerate slice --slicer pr"), {"prusa-slicer"})
        self.assertEqual(self.offered("aerate hollow --holes-on b"), {"bottom", "back"})
        self.assertEqual(self.offered("aerate batch --unit "), {"mm", "cm", "m", "inch"})

    def test_a_value_in_the_word_of_its_option(self):
        self.assertEqual({word.split("=")[-1] for word in self.offered("aerate hollow --process=sl")}, {"sla", "sls"})
        self.assertEqual({word.split("=")[-1] for word in self.offered("aerate hollow --picture=sh")}, {"shot.png"})

    def test_nothing_is_offered_for_numbers(self):
        self.assertEqual(self.offered("aerate hollow --wall "), set())
        self.assertEqual(self.offered("aerate studio --port "), set())

    def test_models(self):
        models = {"bunny.stl", "my model.STL", "part.3mf", "sub", "texts"}
        for command in ("hollow", "pack", "inspect", "support", "slice", "studio"):
            with self.subTest(command):
                self.assertEqual(self.files(f"aerate {command} "), models)
        self.assertEqual(self.files("aerate batch "), models | {"table.csv"})
        self.assertEqual(self.files("aerate hollow bu"), {"bunny.stl"})
        self.assertEqual(self.files("aerate hollow --quiet --wall 2 bu"), {"bunny.stl"})
        self.assertEqual(self.files("aerate hollow sub/"), {"sub/inner.stl"})

    def test_names_with_spaces(self):
        self.assertEqual(self.files("aerate hollow my"), {"my model.STL"})
        self.assertEqual(self.shell.offered("aerate hollow my\\ mo")[-1], "my model.STL")

    def test_a_name_that_begins_with_a_dash_hides_no_other(self):
        dashed = self.folder / "-g.stl"
        dashed.touch()
        try:
            self.assertLessEqual({"bunny.stl", "part.3mf"}, self.files("aerate hollow "))
        finally:
            dashed.unlink()

    def test_files_of_options(self):
        self.assertEqual(self.files("aerate hollow --picture s"), {"shot.png", "sub"})
        self.assertEqual(self.files("aerate --config s"), {"settings.ini", "sub"})
        self.assertEqual(self.files("aerate hollow --config s"), {"settings.ini", "sub"})
        self.assertEqual(self.files("aerate slice --config p"), {"print.gcode"})
        self.assertEqual(self.files("aerate hollow --print-settings p"), {"print.gcode", "part.3mf"})
        self.assertEqual(self.files("aerate hook pri"), {"print.gcode"})
        self.assertEqual(self.files("aerate hollow -o b"), {"bunny.stl"})
        self.assertEqual(self.files("aerate hook --log n"), {"notes.txt"})

    def test_folders(self):
        self.assertEqual(self.files("aerate batch bunny.stl -o "), {"sub", "texts"})
        self.assertEqual(self.files("aerate hook --model-folder s"), {"sub"})

    def test_all_files_where_none_has_the_ending(self):
        self.assertEqual(self.files("aerate hollow texts/"), {"texts/readme.txt"})


if __name__ == "__main__":
    if not is_there(SHELL):
        print(f"{SHELL} is not installed: its completions are not tested")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])

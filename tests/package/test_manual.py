#!/usr/bin/env python3
"""Manual pages as man shows them: test_manual.py FOLDER PROGRAM, where FOLDER has what the build made of the program's options.
Exits with 77, which CTest takes for "skipped", where there is no man."""
import os
import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

PAGES, PROGRAM = Path(sys.argv[1]) / "man1", sys.argv[2]
COMMANDS = ("hollow", "pack", "inspect", "support", "slice", "hook", "batch", "studio")


def help_of(*command):
    return subprocess.run([PROGRAM, *command, "--help"], capture_output=True, text=True, check=True).stdout


def shown(page, width=100):
    """The page as text; what man and groff warn of."""
    environment = {**os.environ, "MANWIDTH": str(width), "LC_ALL": "C.UTF-8", "MANROFFOPT": "-c", "MAN_KEEP_FORMATTING": ""}
    done = subprocess.run(["man", "--warnings", "--no-hyphenation", "--no-justification", "-l", page], env=environment, capture_output=True,
                          text=True, check=True)
    return re.sub("\x1b\\[[0-9;]*m|.\b", "", done.stdout), done.stderr


def in_one_line(text):
    """Without the places of line breaks: a long word may have been broken at a hyphen."""
    return re.sub(r"\s+", "", text)


class Manual(unittest.TestCase):
    def test_one_page_for_each_command(self):
        self.assertEqual({page.name for page in PAGES.iterdir()}, {"aerate.1"} | {f"aerate-{command}.1" for command in COMMANDS})

    def test_no_warning(self):
        for page in sorted(PAGES.iterdir()):
            for width in (60, 80, 200):
                with self.subTest(page.name, width=width):
                    self.assertEqual(shown(page, width)[1], "")
            if shutil.which("mandoc"):
                lint = subprocess.run(["mandoc", "-T", "lint", "-W", "warning", page], capture_output=True, text=True).stdout
                # Pages that are not of a release have no date.
                self.assertEqual([line for line in lint.splitlines() if "missing date" not in line], [])

    def test_every_option_with_its_value_and_description(self):
        for command in COMMANDS:
            page = in_one_line(shown(PAGES / f"aerate-{command}.1")[0])
            # "  -o,--output FILE REQUIRED   The result": the description begins behind two blanks or on the next line.
            rows = re.findall(r"^  (-.*?)(?:  +|\n {20,})(.*)$", help_of(command), re.M)
            self.assertGreater(len(rows), 5)
            for usage, description in rows:
                with self.subTest(command, option=usage):
                    names = re.findall(r"-[-a-z]+", usage.split(" ")[0])
                    self.assertIn(",".join(names), page)
                    self.assertIn(in_one_line(description), page)
                    value = re.match(r"[^ ]* ([A-Z][^ :=]*)", usage)
                    if value and "[=" not in usage:
                        self.assertIn(names[-1] + value[1].replace(" ", ""), page)

    def test_default_values_and_choices(self):
        page = in_one_line(shown(PAGES / "aerate-hollow.1")[0])
        self.assertIn(in_one_line("--wall MM Least thickness between a void and the model's surface (default of the process, here of "
                                  "fdm). Default: 1.2."), page)
        self.assertIn("Oneofenabled,partialanddisabled.Default:enabled.", page)
        self.assertIn("--stand[=MM]", page)

    def test_names_arguments_and_exit_status(self):
        text, _ = shown(PAGES / "aerate-batch.1", 80)
        self.assertIn("aerate-batch - hollow many models", re.sub(r"\s+", " ", text))
        self.assertRegex(text, r"\n +aerate batch \[OPTIONS\] \[?MODELS \.\.\.")
        text, _ = shown(PAGES / "aerate-hollow.1", 80)
        self.assertIn("aerate hollow [OPTIONS] MODEL\n", text)
        self.assertRegex(text, r"\nEXIT STATUS\n +0 +done\n")
        self.assertRegex(text, r"\n +130 +interrupted; no output was written\n")
        text, _ = shown(PAGES / "aerate.1", 80)
        for command in COMMANDS:
            self.assertIn(f"See aerate-{command}(1)", re.sub(r"\s+", " ", text))


if __name__ == "__main__":
    if not shutil.which("man"):
        print("man is not installed: manual pages are not tested")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])

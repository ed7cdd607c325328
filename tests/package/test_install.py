#!/usr/bin/env python3
"""What `cmake --install` puts where: test_install.py BUILD_FOLDER"""
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

BUILD = sys.argv[1]
ROOT = Path(__file__).resolve().parents[2]


class Install(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name) / "of its own"
        subprocess.run(["cmake", "--install", BUILD, "--prefix", cls.folder], check=True, capture_output=True)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def run_installed(self, *arguments):
        return subprocess.run([self.folder / "bin/aerate", *arguments], capture_output=True, text=True)

    def test_files_at_their_places(self):
        for path in ("bin/aerate", "share/man/man1/aerate.1", "share/man/man1/aerate-hollow.1", "share/doc/aerate/README.md",
                     "share/doc/aerate/LICENSE", "share/doc/aerate/docs/package.md",
                     "share/bash-completion/completions/aerate", "share/zsh/site-functions/_aerate",
                     "share/fish/vendor_completions.d/aerate.fish"):
            self.assertTrue((self.folder / path).is_file(), path)

    def test_links_of_the_readme_lead_to_what_is_installed(self):
        readme = (self.folder / "share/doc/aerate/README.md").read_text()
        missing = [page.name for page in (ROOT / "docs").glob("*.md")
                   if f"docs/{page.name}" in readme and not (self.folder / "share/doc/aerate/docs" / page.name).is_file()]
        self.assertEqual(missing, [])

    def test_the_program_runs_from_there(self):
        with tempfile.TemporaryDirectory() as folder:
            done = self.run_installed("hollow", ROOT / "samples/bunny.stl", "-o", f"{folder}/hollow.stl", "--quiet")
            self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_the_menu_opens_the_studio_where_there_is_one(self):
        has_studio = (self.folder / "share/aerate/studio.html").is_file()
        entry = self.folder / "share/applications/aerate-studio.desktop"
        icon = self.folder / "share/icons/hicolor/scalable/apps/aerate.svg"
        self.assertEqual((entry.is_file(), icon.is_file()), (has_studio, has_studio))
        if not has_studio:
            self.skipTest("built without the studio")
        lines = dict(line.split("=", 1) for line in entry.read_text().splitlines() if "=" in line)
        self.assertEqual((lines["Exec"], lines["Icon"]), ("aerate studio %F", icon.stem))
        self.assertEqual(self.run_installed("studio", "--help").returncode, 0)
        if shutil.which("desktop-file-validate"):
            checked = subprocess.run(["desktop-file-validate", entry], capture_output=True, text=True)
            self.assertEqual((checked.returncode, checked.stdout + checked.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])

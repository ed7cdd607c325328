#!/usr/bin/env python3
"""What `cmake --install` puts where: test_install.py BUILD_FOLDER"""
import os
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

    def test_shells_find_the_completions_by_themselves(self):
        share = self.folder / "share"
        plain = Path(self.temporary.name) / "share"  # bash-completion splits its variable at blanks
        plain.symlink_to(share)
        asked = 0
        if shutil.which("fish"):  # which asks only for commands that are there
            done = subprocess.run(["fish", "-c", 'complete -C "aerate hol"'], capture_output=True, text=True,
                                  env={**os.environ, "PATH": f"{self.folder}/bin:{os.environ['PATH']}",
                                       "XDG_DATA_DIRS": f"{share}:/usr/share", "HOME": self.temporary.name})
            self.assertTrue(done.stdout.startswith("hollow\t"), done.stdout + done.stderr)
            asked += 1
        loader = Path("/usr/share/bash-completion/bash_completion")
        if loader.is_file():
            done = subprocess.run(["bash", "--norc", "-c", f". {loader}; _completion_loader aerate; complete -p aerate"], capture_output=True,
                                  text=True, env={**os.environ, "BASH_COMPLETION_USER_DIR": f"{plain}/bash-completion"})
            self.assertEqual(done.stdout, "complete -F _aerate aerate\n", done.stderr)
            asked += 1
        if shutil.which("zsh"):
            command = f"fpath=('{share}/zsh/site-functions' $fpath); autoload -Uz compinit; compinit -D -u; print $_comps[aerate]"
            done = subprocess.run(["zsh", "-f", "-c", command], capture_output=True, text=True)
            self.assertEqual(done.stdout, "_aerate\n", done.stderr)
            asked += 1
        if not asked:
            self.skipTest("neither fish nor zsh nor bash-completion is installed")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])

#!/usr/bin/env python3
"""The self-contained archive in a root that has only libc: test_archive.py PROGRAM, where PROGRAM is that of the build, whose results are those
of the unpacked one to the byte. AERATE_RELEASE names the folder that scripts/release made. Exits with 77, which CTest takes for "skipped",
where there is none, or where neither bubblewrap nor chroot works: it says which."""
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import unittest
from pathlib import Path

PROGRAM = Path(sys.argv[1]).resolve()
ROOT = Path(__file__).resolve().parents[2]
LIBC = ("libc.so.6", "libm.so.6", "libpthread.so.0", "libdl.so.2", "librt.so.1")  # older ones' parts are files of their own


def skip(why):
    print(f"NOT TESTED: the archive in a root that has only libc: {why}")
    sys.exit(77)


def works(*command):
    try:
        return subprocess.run(command, capture_output=True).returncode == 0
    except OSError:
        return False


def way_in():
    """How a command is run in another root, with its own /proc; None where that cannot be done."""
    if works("bwrap", "--unshare-all", "--ro-bind", "/", "/", "--proc", "/proc", "true"):
        return "bwrap"
    if works("unshare", "--mount", "chroot", "/", "true"):
        return "chroot"
    return None


WAY = way_in()


def add_libc(root):
    """libc's own libraries as this process has them, and the loader."""
    mapped = {line.split()[-1] for line in Path("/proc/self/maps").read_text().splitlines() if "/" in line}
    folder = next(Path(path).parent for path in mapped if path.endswith("/libc.so.6"))
    loader = Path("/lib64/ld-linux-x86-64.so.2")
    for source in [folder / name for name in LIBC] + [loader]:
        target = root / source.relative_to("/")
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source, target)


class Archive(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.root = Path(cls.temporary.name) / "root"
        for folder in ("proc", "dev", "tmp", "work", "opt/some where"):
            (cls.root / folder).mkdir(parents=True)
        add_libc(cls.root)
        archive, = Path(os.environ["AERATE_RELEASE"]).glob("aerate-*-linux-*.tar.xz")
        with tarfile.open(archive) as files:
            cls.members = files.getmembers()
            files.extractall(cls.root / "opt/some where", filter="data" if hasattr(tarfile, "data_filter") else None)
        cls.folder = cls.root / "opt/some where" / archive.name.removesuffix(".tar.xz")
        cls.installed = "/" + str((cls.folder / "bin/aerate").relative_to(cls.root))
        for name in ("bunny.stl", "pawn.obj", "bracket.stl"):
            shutil.copy(ROOT / "samples" / name, cls.root / "work")
        shutil.copy(ROOT / "tests/data/scene.3ds", cls.root / "work")
        cls.outside = Path(cls.temporary.name) / "outside"
        shutil.copytree(cls.root / "work", cls.outside)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def inside(self, *arguments, program=None, **how):
        command = {
            "bwrap": ["bwrap", "--unshare-all", "--die-with-parent", "--bind", self.root, "/", "--proc", "/proc", "--dev", "/dev", "--chdir", "/work",
                      "--clearenv"],
            # Its environment is empty but for what a shell sets.
            "chroot": ["unshare", "--mount", "sh", "-c", 'mount -t proc proc "$0/proc" && cd "$0/work" && exec env -i /usr/sbin/chroot "$0" "$@"',
                       self.root],
        }[WAY]
        if WAY == "chroot":  # begins in the root's own folder
            arguments = [f"/work/{argument}" if (self.root / "work" / argument).exists() else argument for argument in arguments]
        return subprocess.run([*command, program or self.installed, *arguments], capture_output=True, text=True, **how)

    def same_as_outside(self, *arguments, output):
        """Runs both programs, in folders with the same files."""
        output = f"/work/{output}"
        done = self.inside(*arguments, "-o", output, "--quiet")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        expected = self.outside / Path(output).name
        subprocess.run([PROGRAM, *arguments, "-o", expected, "--quiet"], cwd=self.outside, check=True)
        self.assertEqual((self.root / output[1:]).read_bytes(), expected.read_bytes())

    def test_the_same_bytes_as_the_program_of_the_build(self):
        self.same_as_outside("hollow", "bunny.stl", output="bunny-hollow.stl")
        self.same_as_outside("hollow", "pawn.obj", "--process", "sla", output="pawn-hollow.3mf")
        self.same_as_outside("pack", "bunny.stl", "--max-voids", "40", output="spheres.csv")

    def test_what_needs_openvdb_and_assimp(self):
        self.same_as_outside("hollow", "bunny.stl", "--surface", "remesh", "--voxel", "0.6", "--min-radius", "1.5", output="remeshed.stl")
        done = self.inside("inspect", "/work/scene.3ds", "--self-intersections")
        self.assertIn(done.returncode, (0, 4), done.stderr)
        self.assertIn("triangles", done.stdout)

    def test_pictures_and_pages(self):
        done = self.inside("hollow", "/work/bunny.stl", "-o", "/work/seen.stl", "--picture", "/work/seen.png", "--view", "/work/seen.html", "--quiet")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        subprocess.run([PROGRAM, "hollow", "bunny.stl", "-o", "seen.stl", "--picture", "seen.png", "--quiet"], cwd=self.outside, check=True)
        self.assertEqual((self.root / "work/seen.png").read_bytes(), (self.outside / "seen.png").read_bytes())
        page = (self.root / "work/seen.html").read_text()
        self.assertIn("<!doctype html>", page[:100].lower())
        self.assertGreater(len(page), 500_000)

    def test_a_batch_starts_the_program_again(self):
        done = self.inside("batch", "/work/bunny.stl", "/work/bracket.stl", "-o", "/work/results", "--pictures")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("2 of 2 models are done", done.stdout)
        subprocess.run([PROGRAM, "hollow", "bracket.stl", "-o", "by itself.stl", "--quiet"], cwd=self.outside, check=True)
        self.assertEqual((self.root / "work/results/bracket-hollow.stl").read_bytes(), (self.outside / "by itself.stl").read_bytes())

    def test_through_a_link_and_as_a_hook(self):
        (self.root / "bin").mkdir(exist_ok=True)
        link = self.root / "bin/linked"
        if not link.is_symlink():
            link.symlink_to(self.installed)
        done = self.inside("hook", "--print-setup", "prusa-slicer", program="/bin/linked")
        self.assertEqual(done.stderr, "")
        # Where it really is, as a slicer in a sandbox has to be told.
        self.assertEqual(done.stdout, f"'{self.installed}' hook --model /path/to/model.stl\n")

    def test_the_studio_is_served(self):
        if WAY != "bwrap":
            self.skipTest("needs a network of its own, by bubblewrap")
        inside = ["bwrap", "--unshare-all", "--die-with-parent", "--bind", self.root, "/", "--proc", "/proc", "--dev", "/dev", "--clearenv"]
        with subprocess.Popen([*inside, self.installed, "studio", "--no-browser"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True) as studio:
            self.assertRegex(studio.stdout.readline(), r"^http://127\.0\.0\.1:\d+/#")
            studio.kill()

    def test_the_terms_of_all_that_is_inside(self):
        licences = self.folder / "licences"
        rows = [line.split() for line in (licences / "SOURCES").read_text().splitlines()]
        packages = {row[0]: row[1] for row in rows if len(row) == 3}
        libraries = {path.name for path in (self.folder / "lib").iterdir()}
        self.assertEqual({name for name in packages if name != "(headers)"}, libraries)
        self.assertFalse(libraries & {*LIBC, "ld-linux-x86-64.so.2"})
        for row in rows:
            if len(row) == 3:
                self.assertGreater((licences / f"{row[1]}.txt").stat().st_size, 500, row)
        self.assertIn("GNU GENERAL PUBLIC LICENSE", (licences / "aerate.txt").read_text())
        self.assertIn("three.js authors", (licences / "three.js.txt").read_text())
        for path in licences.glob("*.txt"):
            for text in re.findall(r"/usr/share/common-licenses/([A-Za-z]+[0-9]?(?:-[0-9.]*[0-9])?)", path.read_text(errors="replace")):
                self.assertTrue((licences / "common-licenses" / text).is_file(), f"{path.name}: {text}")

    def test_the_libc_that_it_needs_is_told(self):
        needed = set()
        for path in [self.folder / "bin/aerate", *(self.folder / "lib").iterdir()]:
            symbols = subprocess.run(["objdump", "-T", path], capture_output=True, text=True, check=True).stdout
            needed |= {tuple(map(int, version.split("."))) for version in re.findall(r"GLIBC_([0-9.]+)", symbols)}
        told = ".".join(map(str, max(needed)))
        self.assertIn(f"glibc {told} or newer", (self.folder / "README").read_text())
        self.assertIn(f"glibc {told} or newer", (ROOT / "docs/package.md").read_text())

    def test_all_of_it_is_everybodys_to_read_and_nobodys_of_this_machine(self):
        top = self.folder.name
        for member in self.members:
            self.assertTrue(member.name == top or member.name.startswith(top + "/"), member.name)
            self.assertEqual((member.uid, member.gid, member.mode & 0o7022), (0, 0, 0), member.name)
            self.assertEqual(member.mode & 0o444, 0o444, member.name)
        self.assertEqual(len({member.mtime for member in self.members}), 1)
        names = [name.encode() for name in (f"{ROOT}/", f"{PROGRAM.parent}/")]
        for path in [self.folder / "bin/aerate", *self.folder.glob("share/**/*")]:
            if path.is_file():
                data = path.read_bytes()
                self.assertFalse(any(name in data for name in names), path)

    def test_pages_completions_and_menu_are_inside(self):
        for path in ("share/man/man1/aerate-hollow.1", "share/bash-completion/completions/aerate", "share/zsh/site-functions/_aerate",
                     "share/fish/vendor_completions.d/aerate.fish", "share/applications/aerate-studio.desktop", "README",
                     "share/doc/aerate/docs/package.md"):
            self.assertTrue((self.folder / path).is_file(), path)


if __name__ == "__main__":
    if not os.environ.get("AERATE_RELEASE"):
        skip("AERATE_RELEASE names no folder of scripts/release")
    if WAY is None:
        skip("neither bubblewrap nor chroot works here")
    print(f"by {WAY}")
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])

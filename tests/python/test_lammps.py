"""aerate pack -o packing.data, read by LAMMPS."""

import shutil
import subprocess

import numpy as np
import pytest
from conftest import BUNNY, ROOT, run_program
from grains import packed

SCRIPT = """
units lj
atom_style sphere
boundary f f f
read_data packing.data
write_dump all custom read.txt id type diameter mass x y z modify sort id format float %.17g
"""


@pytest.mark.skipif(shutil.which("lmp") is None, reason="lammps is not installed")
def test_lammps_reads_places_diameters_and_the_box(fresh):
    spheres, _ = packed(fresh)
    report = run_program("pack", BUNNY, "-o", "packing.data", "--min-radius", 0.5, "--max-voids", 50)
    (fresh / "script").write_text(SCRIPT)
    done = subprocess.run(["lmp", "-in", "script", "-log", "none"], capture_output=True, text=True)
    reading = done.stdout.partition("read_data CPU")[0]
    assert done.returncode == 0 and "WARNING" not in reading, done.stdout + done.stderr
    lines = (fresh / "read.txt").read_text().splitlines()
    first = lines.index("ITEM: ATOMS id type diameter mass x y z") + 1
    read = np.array([line.split() for line in lines[first:]], float)
    assert np.array_equal(read[:, 0], np.arange(1, 51)) and np.all(read[:, 1] == 1)
    assert np.allclose(read[:, 2], 2 * spheres[:, 3], rtol=4e-16, atol=0)  # LAMMPS holds half of it
    assert np.allclose(read[:, 3], 4 / 3 * np.pi * spheres[:, 3] ** 3, rtol=1e-12, atol=0)  # of density 1
    assert np.array_equal(read[:, 4:7], spheres[:, :3])
    bounds = [line.split() for line in lines[lines.index("ITEM: BOX BOUNDS ff ff ff") + 1:][:3]]
    model = report["input"]["box"]
    assert np.allclose(np.array(bounds, float).T, [model["lower_mm"], model["upper_mm"]], rtol=1e-12)


@pytest.mark.skipif(shutil.which("lmp") is None, reason="lammps is not installed")
def test_the_script_of_the_docs_gives_a_density(fresh):
    spheres, _ = packed(fresh)
    run_program("pack", BUNNY, "-o", "packing.data", "--min-radius", 0.5, "--max-voids", 50)
    text = (ROOT / "docs/packing.md").read_text()
    block = text[text.index("    units lj"):].partition("\n\n")[0]
    assert "set type 1 density 0.0026" in block
    (fresh / "script").write_text(block + "\nwrite_dump all custom read.txt mass modify sort id format float %.17g\n")
    done = subprocess.run(["lmp", "-in", "script", "-log", "none"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    masses = np.loadtxt("read.txt", skiprows=9)
    assert np.allclose(masses, 0.0026 * 4 / 3 * np.pi * spheres[:, 3] ** 3, rtol=1e-12, atol=0)


def test_the_file_says_its_units(fresh):
    run_program("pack", BUNNY, "-o", "packing.data", "--max-voids", 5)
    first = (fresh / "packing.data").read_text().splitlines()[0]
    assert "lengths in mm" in first and "density 1" in first

"""aerate pack -o packing.txt, read by YADE."""

import shutil
import subprocess

import numpy as np
import pytest
from conftest import BUNNY, run_program
from grains import packed

SCRIPT = """
from yade import ymport, pack
O.bodies.append(ymport.text("packing.txt"))
spheres = pack.SpherePack()
spheres.fromSimulation()
with open("read.txt", "w") as file:
    for centre, radius in spheres:
        file.write(" ".join(repr(float(number)) for number in (*centre, radius)) + chr(10))
metres = ymport.text("packing.txt", scale=1e-3)
with open("scaled.txt", "w") as file:
    file.write(repr(float(metres[0].shape.radius)))
"""


@pytest.mark.skipif(shutil.which("yade") is None, reason="yade is not installed")
def test_yade_reads_places_and_radii(fresh):
    spheres, _ = packed(fresh)
    run_program("pack", BUNNY, "-o", "packing.txt", "--min-radius", 0.5, "--max-voids", 50)
    (fresh / "script.py").write_text(SCRIPT)
    done = subprocess.run(["yade", "-n", "-x", "script.py"], capture_output=True, text=True, timeout=120)
    assert (fresh / "scaled.txt").exists(), done.stdout + done.stderr
    assert np.array_equal(np.loadtxt("read.txt"), spheres)
    assert float((fresh / "scaled.txt").read_text()) == pytest.approx(spheres[0, 3] / 1000, rel=1e-12)


def test_it_is_a_table_for_numpy_too(fresh):
    spheres, _ = packed(fresh)
    run_program("pack", BUNNY, "-o", "packing.txt", "--min-radius", 0.5, "--max-voids", 50)
    assert np.array_equal(np.loadtxt("packing.txt"), spheres)
    assert "lengths in mm" in (fresh / "packing.txt").read_text()

"""What the tests of the module share. AERATE names the program that it is held against."""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ["AERATE"]
sys.path.insert(0, str(ROOT / "tests/independent"))
from model_files import read_model, write_model  # noqa: E402

FOLDER = tempfile.TemporaryDirectory(prefix="aerate-test-")
BUNNY = Path(FOLDER.name) / "bunny.stl"  # 32 mm long
write_model(BUNNY, read_model(ROOT / "samples/bunny.stl").corners * 0.4)


def box(lower, upper, inward=False):
    """A box as vertices and triangles."""
    corners = np.array([[(lower, upper)[i >> axis & 1][axis] for axis in range(3)] for i in range(8)], float)
    faces = np.array([(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4),
                      (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)])
    return corners, faces[:, ::-1] if inward else faces


def cube(side=20.0):
    return box((0, 0, 0), (side, side, side))


def run_program(*words):
    """The program with these words; its report."""
    done = subprocess.run([PROGRAM, *map(str, words), "--json", "-"], capture_output=True, check=True)
    return json.loads(done.stdout)


def without_costs(report, *more):
    """A report without what differs from run to run, and from file to file."""
    kept = {key: value for key, value in report.items() if key not in ("stages", "seconds", "peak_memory_bytes", *more)}
    if "output" in kept:
        kept["output"] = {key: value for key, value in kept["output"].items() if key not in ("path", "bytes")}
    return kept


def corners_of(model):
    """Corner by corner: what a model is whatever the numbers of its vertices."""
    return model.vertices[model.triangles]


@pytest.fixture
def fresh(tmp_path, monkeypatch):
    """A folder of its own, which is the current one."""
    monkeypatch.chdir(tmp_path)
    return tmp_path

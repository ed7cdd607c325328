"""The models that supports are measured on, as arrays of triangles' corners."""
import math
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests/independent")]
from model_files import read_model  # noqa: E402


def box(lower, upper):
    corners = np.array([[(upper if c >> i & 1 else lower)[i] for i in range(3)] for c in range(8)], float)
    faces = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)]
    return corners[np.array(faces)]


def ball(centre, radii, n=32):
    """Also an ellipsoid."""
    def at(i, j):
        u, v = math.pi * i / n, math.pi * 2 * (j % (2 * n)) / (2 * n)
        return [centre[0] + radii[0] * math.sin(u) * math.cos(v), centre[1] + radii[1] * math.sin(u) * math.sin(v), centre[2] + radii[2] * math.cos(u)]
    triangles = []
    for i in range(n):
        for j in range(2 * n):
            a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            triangles += ([] if i == n - 1 else [[a, b, c]]) + ([] if i == 0 else [[a, c, d]])
    return np.array(triangles)


def tee():
    return np.concatenate([box((25, 0, 0), (35, 20, 30)), box((0, 0, 30), (60, 20, 36))])


def arch(n=64):
    """A block of 60 x 20 x 28 mm with a half-round way of 40 mm through it, as strips."""
    xs = [10 + 20 - 20 * math.cos(math.pi * k / n) for k in range(n + 1)]
    zs = [20 * math.sin(math.pi * k / n) for k in range(n + 1)]
    parts = [box((0, 0, 0), (10, 20, 28)), box((50, 0, 0), (60, 20, 28))]
    for k in range(n):
        low = np.array([[xs[k], zs[k]], [xs[k + 1], zs[k + 1]]])
        strip = box((xs[k], 0, 0), (xs[k + 1], 20, 28)).reshape(-1, 3)
        for p in strip:
            if p[2] == 0:
                p[2] = low[0, 1] if p[0] == xs[k] else low[1, 1]
        parts.append(strip.reshape(-1, 3, 3))
    return np.concatenate(parts)


def figure():
    """It stands, and holds one arm out."""
    return np.concatenate([box((0, 0, 0), (8, 12, 30)), box((12, 0, 0), (20, 12, 30)), box((0, 0, 30), (20, 12, 60)), ball((10, 6, 68), (8, 8, 10)),
                           ball((35, 6, 54), (24, 4, 4)), ball((59, 6, 52), (5, 5, 6))])


def bracket():
    corners = read_model(ROOT / "samples/bracket.stl").corners
    return corners[:, :, [2, 1, 0]] * np.array([1, 1, -1])  # its -x is up


def models(folder):
    made = {"T-shaped bridge": tee, "arch": arch, "figure with an arm": figure, "bracket, turned": bracket}
    for name, file in [("bunny, 100 mm", "bunny-100mm.stl"), ("dragon, 100 mm", "dragon-47k-100mm.stl")]:
        if folder and (folder / file).exists():
            made[name] = lambda path=folder / file: read_model(path).corners
    return made


def write_stl(path, corners):
    record = np.zeros(len(corners), dtype=[("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    record["v"] = corners
    path.write_bytes(b"\0" * 80 + np.uint32(len(corners)).tobytes() + record.tobytes())

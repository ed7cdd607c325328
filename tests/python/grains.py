"""What the files for programs that simulate grains are held against."""

import csv

import numpy as np
from conftest import BUNNY, run_program


def packed(folder):
    """The same 50 spheres as a table: (x, y, z, radius), and their kinds."""
    run_program("pack", BUNNY, "-o", folder / "table.csv", "--min-radius", 0.5, "--max-voids", 50)
    with open(folder / "table.csv") as table:
        rows = list(csv.DictReader(table))
    numbers = [[float(row[name]) for name in ("x", "y", "z", "radius")] for row in rows]
    return np.array(numbers), [row["kind"] for row in rows]

#!/usr/bin/python3
"""The solver and the voxels of bench/bench_stiffness, against what is known in closed form."""
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

try:
    import numpy as np
    import scipy  # noqa: F401
except ImportError:
    print("without NumPy and SciPy nothing is tested here")
    sys.exit(77)

ROOT = Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path[:0] = [str(ROOT / "tests/independent"), str(ROOT / "bench/stiffness")]
from model_files import read_model, write_model  # noqa: E402
from elastic import Block, shear_modulus, youngs_modulus  # noqa: E402
from voxels import formula_fractions, mesh_fractions  # noqa: E402


def box(lower, upper, inward=False):
    corners = np.array([[(lower, upper)[i >> axis & 1][axis] for axis in range(3)] for i in range(8)], float)
    faces = np.array([(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4),
                      (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)])
    return corners[faces[:, ::-1] if inward else faces]


class Solver(unittest.TestCase):
    def test_a_solid_block_has_the_moduli_of_its_material(self):
        for poisson in (0.0, 0.2, 0.35):
            block = Block(np.ones((8, 12, 16)), poisson)
            for axis in range(3):
                self.assertAlmostEqual(youngs_modulus(block, axis, 1e-7), 1, places=6)
            self.assertAlmostEqual(shear_modulus(block, 1e-7), 1 / (2 * (1 + poisson)), places=6)

    def test_a_laminate_is_that_of_voigt_along_and_of_reuss_across(self):
        layers = np.where(np.arange(16) % 8 < 3, 1.0, 0.1)
        density = np.ones((16, 16, 16)) * layers  # along z
        block = Block(density, 0.0)
        self.assertAlmostEqual(youngs_modulus(block, 0, 1e-8), layers.mean(), places=6)
        self.assertAlmostEqual(youngs_modulus(block, 2, 1e-8), 1 / (1 / layers).mean(), places=6)

    def test_walls_along_the_load_carry_by_their_share_and_none_across(self):
        density = np.zeros((32, 32, 32))
        density[8:12], density[24:28] = 1, 1
        density[:, :, :2], density[:, :, -2:] = 1, 1
        block = Block(density, 0.0)
        self.assertAlmostEqual(youngs_modulus(block, 2), 0.25, delta=0.05)  # the plates spread the load
        self.assertLess(youngs_modulus(block, 2), 0.36)  # no more than by Voigt
        self.assertGreater(youngs_modulus(block, 2), 0.25)

    def test_a_porous_block_is_between_nothing_and_the_bounds_and_falls_with_refinement(self):
        def hollow(x, y, z):
            return (x - 0.5) ** 2 + (y - 0.5) ** 2 + (z - 0.5) ** 2 > 0.45 ** 2
        found = []
        for n in (12, 24, 48):
            block = Block(formula_fractions(hollow, (0, 0, 0), 1 / n, (n,) * 3), 0.35)
            found.append(youngs_modulus(block, 2))
            self.assertLess(found[-1], 1 - 4 / 3 * np.pi * 0.45 ** 3)
        # Coarse cubes are too stiff; each halving leaves less than 0.6 of the change before.
        self.assertGreater(found[0], found[1])
        self.assertGreater(found[1], found[2])
        self.assertLess(found[1] - found[2], 0.6 * (found[0] - found[1]))
        self.assertLess(found[1] / found[2], 1.03)

    def test_multigrid_needs_few_steps_and_gives_what_a_direct_solution_gives(self):
        density = np.random.default_rng(3).uniform(0, 1, (32, 32, 32))
        density[density < 0.3] = 0
        density[:, :, 0], density[:, :, -1] = 1, 1
        block = Block(density)
        one = youngs_modulus(block, 2, 1e-7)
        self.assertLess(block.steps, 30)
        small = Block(density[:8, :8, :8])  # few enough unknowns for no coarser level
        self.assertEqual(small.coarse, [])
        again = Block(density[:8, :8, :8])
        again.LARGEST_DIRECT = 500
        again.coarse = again.coarse_matrices()
        self.assertGreater(len(again.coarse), 0)
        self.assertAlmostEqual(youngs_modulus(small, 0, 1e-9), youngs_modulus(again, 0, 1e-9), places=7)
        self.assertLess(one, density.mean())


class Voxels(unittest.TestCase):
    def test_shares_of_a_box_with_a_box_inside_are_exact_where_columns_tell(self):
        corners = np.concatenate([box((0, 0, 0), (8, 8, 8)), box((2, 2, 2.25), (6, 6, 5.6), inward=True)])
        share = mesh_fractions(corners, (0, 0, 0), 1.0, (8, 8, 8))
        expected = np.ones((8, 8, 8))
        expected[2:6, 2:6, 2:6] = [0.25, 0, 0, 1 - 0.6]
        np.testing.assert_allclose(share, expected, atol=1e-9)

    def test_shares_of_a_ball_by_triangles_are_those_by_formula(self):
        n = 40
        u, v = np.meshgrid(np.linspace(0, np.pi, n + 1), np.linspace(0, 2 * np.pi, 2 * n + 1), indexing="ij")
        grid = 5 + 4 * np.stack([np.sin(u) * np.cos(v), np.sin(u) * np.sin(v), np.cos(u)], axis=-1)
        grid[0], grid[-1], grid[:, -1] = (5, 5, 9), (5, 5, 1), grid[:, 0]
        a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
        corners = np.concatenate([np.stack([a, b, c], axis=2).reshape(-1, 3, 3), np.stack([a, c, d], axis=2).reshape(-1, 3, 3)])
        by_mesh = mesh_fractions(corners, (0, 0, 0), 0.5, (20, 20, 20), each=8)
        by_formula = formula_fractions(lambda x, y, z: (x - 5) ** 2 + (y - 5) ** 2 + (z - 5) ** 2 < 16, (0, 0, 0), 0.5,
                                       (20, 20, 20), each=8)
        self.assertLess(abs(by_mesh - by_formula).max(), 0.06)
        self.assertAlmostEqual(by_mesh.sum() / 8, 4 / 3 * np.pi * 64, delta=1.5)

    def test_an_open_mesh_is_refused(self):
        # Without one triangle of the top.
        corners = box((0, 0, 0), (8, 8, 8))
        top = (corners[:, :, 2] == 8).all(axis=1)
        with self.assertRaises(ValueError):
            mesh_fractions(np.delete(corners, np.flatnonzero(top)[0], axis=0), (0, 0, 0), 1.0, (8, 8, 8))


@unittest.skipUnless("AERATE" in os.environ, "the program is named by AERATE")
class Report(unittest.TestCase):
    def test_blocks_are_as_far_from_the_bound_as_the_report_says(self):
        for shape in ("spheres", "cells"):
            with self.subTest(shape), tempfile.TemporaryDirectory() as folder:
                block, result = Path(folder, "block.stl"), Path(folder, "hollow.stl")
                write_model(block, box((0, 0, 0), (30, 30, 30)))
                done = subprocess.run([os.environ["AERATE"], "hollow", block, "-o", result, "--json", "-", "--wall", "0.9375",
                                       "--gap", "1.5", "--max-radius", "5", "--shape", shape, "--bridge", "10"],
                                      capture_output=True, text=True, check=True)
                told = json.loads(done.stdout)["strength_and_balance"]
                block = Block(mesh_fractions(read_model(result).corners, (0, 0, 0), 30 / 32, (32, 32, 32), each=8))
                mean = np.mean([youngs_modulus(block, axis) for axis in range(3)]) / told["relative_stiffness_upper_bound"]
                self.assertGreater(mean, told["blocks_relative_to_bound"]["least"])
                # Cubes as coarse as these are some 4 % stiffer than those behind the report's figures.
                self.assertLess(mean, told["blocks_relative_to_bound"]["most"] * 1.04)


if __name__ == "__main__":
    unittest.main()

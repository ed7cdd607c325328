"""Runs OrcaSlicer's plugin against a stub of the documented interface (orca_stub.py) and the built program.

    test_orca_plugin.py [PROGRAM]      without a program what needs it is skipped
"""

import sys

sys.dont_write_bytecode = True  # no compiled files among the sources

import importlib.util
import json
import math
import os
import random
import stat
import tempfile
import threading
import time
import unittest

import orca_stub as stub

PLUGIN = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../printing/slicers/orca/AerateInfill.py")
PROGRAM = None
LAYER = 0.5

IDENTITY = [[float(i == j) for j in range(4)] for i in range(4)]
# A prism on a right triangle: its box and it turned have other centres, and no packing of it has ties.
PRISM = (
    [(0, 0, 0), (36, 0, 0), (0, 25, 0), (0, 0, 18), (36, 0, 18), (0, 25, 18)],
    [(0, 2, 1), (3, 4, 5), (0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (2, 0, 3), (2, 3, 5)],
)


def box_mesh(x0, y0, z0, x1, y1, z1):
    corners = [(x, y, z) for z in (z0, z1) for y in (y0, y1) for x in (x0, x1)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return corners, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def globe(radius, steps=48):
    """A sphere at the origin, its corners on it."""
    vertices = [(0.0, 0.0, radius), (0.0, 0.0, -radius)]
    for i in range(1, steps):
        polar = math.pi * i / steps
        for j in range(2 * steps):
            turn = math.pi * j / steps
            across = radius * math.sin(polar)
            vertices.append((across * math.cos(turn), across * math.sin(turn), radius * math.cos(polar)))
    triangles = []

    def at(i, j):
        return 2 + (i - 1) * 2 * steps + j % (2 * steps)

    for j in range(2 * steps):
        triangles += [(0, at(1, j), at(1, j + 1)), (1, at(steps - 1, j + 1), at(steps - 1, j))]
        for i in range(1, steps - 1):
            triangles += [(at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1))]
    return vertices, triangles


def times(*matrices):
    result = IDENTITY
    for m in matrices:
        result = [[sum(result[i][k] * m[k][j] for k in range(4)) for j in range(4)] for i in range(4)]
    return result


def scaling(x, y, z):
    return [[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0], [0.0, 0.0, 0.0, 1.0]]


def moving(x, y, z):
    return [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z], [0.0, 0.0, 0.0, 1.0]]


def turning(axis, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    a, b = [(1, 2), (2, 0), (0, 1)][axis]
    m = [row[:] for row in IDENTITY]
    m[a][a], m[a][b], m[b][a], m[b][b] = c, -s, s, c
    return m


def applied(matrix, p):
    return tuple(sum(matrix[i][k] * (*p, 1.0)[k] for k in range(4)) for i in range(3))


def volume(vertices, triangles):
    total = 0.0
    for u, v, w in triangles:
        (a, b, c), (d, e, f), (g, h, i) = vertices[u], vertices[v], vertices[w]
        total += a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    return total / 6


def convex_section(vertices, triangles, z):
    """Of a convex mesh, counter-clockwise, by the angle round its middle."""
    points = set()
    for triangle in triangles:
        for a, b in zip(triangle, triangle[1:] + triangle[:1]):
            p, q = vertices[a], vertices[b]
            if (p[2] > z) != (q[2] > z):
                t = (z - p[2]) / (q[2] - p[2])
                points.add((round(p[0] + t * (q[0] - p[0]), 9), round(p[1] + t * (q[1] - p[1]), 9)))
    x, y = (sum(p[k] for p in points) / len(points) for k in range(2))
    return sorted(points, key=lambda p: math.atan2(p[1] - y, p[0] - x)), (x, y)


class Sliced:
    """A convex object as Orca slices it; the instance after which it is printed may be another than the first."""

    def __init__(self, mesh=PRISM, matrix=IDENTITY, turn=0.0, name="prism", density="15%", values=None, more=()):
        on_bed = moving(0, 0, -min(applied(matrix, p)[2] for p in mesh[0]))
        first = times(moving(120, 80, 0), on_bed, matrix)
        trafo = times(turning(2, turn), on_bed, matrix)
        still = [applied(times(on_bed, matrix), p) for p in mesh[0]]
        centre = [(min(p[k] for p in still) + max(p[k] for p in still)) / 2 for k in range(2)] + [0.0]
        self.centre = applied(turning(2, turn), centre)
        self.vertices = [tuple(a - b for a, b in zip(applied(trafo, p), self.centre)) for p in mesh[0]]
        self.mirrored = volume(self.vertices, mesh[1]) < 0
        height = max(p[2] for p in self.vertices)
        self.layers = []
        count = int(height / LAYER)
        for k in range(count):
            z = (k + 0.5) * LAYER
            outline, (x, y) = convex_section(self.vertices, mesh[1], z)
            inner = stub.polygon_mm([(x + 0.93 * (px - x), y + 0.93 * (py - y)) for px, py in outline])
            kind = stub.SurfaceType.stInternal if 3 <= k < count - 3 else stub.SurfaceType.stInternalSolid
            surface = stub.Surface(kind, inner)
            surface.thickness, surface.bridge_angle, surface.hidden = 0.1 * k, 0.5, k
            top = stub.Surface(stub.SurfaceType.stTop, stub.rectangle(-1, -1, 1, 1))
            settings = {"sparse_infill_density": density, "wall_loops": "2", "outer_wall_line_width": "0.42"}
            settings.update({"inner_wall_line_width": "0.45"})
            regions = [stub.LayerRegion([top, surface], settings)]
            regions += [stub.LayerRegion([surface._copy()], other) for other in more]
            self.layers.append(stub.Layer(z, LAYER, [stub.polygon_mm(outline)], regions))
        xs, ys = [p[0] for p in self.vertices], [p[1] for p in self.vertices]
        wide, deep = (round((max(v) - min(v)) / 2 / stub.UNIT) for v in (xs, ys))
        # The volume has a matrix of its own, which its mesh is before.
        own = times(moving(3, -2, 1), turning(0, 30))
        back = times(turning(0, -30), moving(-3, 2, -1))
        local = ([applied(back, p) for p in mesh[0]], mesh[1])
        self.model = stub.ModelObject(
            name,
            [stub.ModelVolume(local, own)],
            [stub.ModelInstance(first), stub.ModelInstance(times(moving(-9, 200, 0), trafo))],
            {},
        )
        self.object = stub.PrintObject(self.model, trafo, (-wide, -deep, wide, deep), self.layers, values or {})

    def state(self):
        """Everything that infill is made of."""
        return [
            [
                (
                    surface.surface_type,
                    surface.expolygon.rings(),
                    surface.thickness,
                    surface.bridge_angle,
                    surface.extra_perimeters,
                )
                for surface in region.fill_surfaces.surfaces
            ]
            for layer in self.layers
            for region in layer.regions()
        ]


class WithPlugin(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.storage = os.path.join(self.folder, "plugin_data")
        os.mkdir(self.storage)
        self.host = stub.Host(self.storage)
        sys.modules["orca"] = self.host.module()
        self.addCleanup(sys.modules.pop, "orca")
        spec = importlib.util.spec_from_file_location("AerateInfill", PLUGIN)
        self.plugin = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(self.plugin)
        self.host.packages[0]().register_capabilities()
        self.capability = self.host.capabilities[0]()

    def options(self, **options):
        self.capability.saved = json.dumps(dict({"program": PROGRAM or "aerate"}, **options))

    def execute(self, sliced, step=stub.Step.posPrepareInfill, cancelled=lambda: False):
        settings = {"sparse_infill_density": "15%", "nozzle_diameter": "0.4"}
        return self.host.execute(self.capability, stub.Context(step, sliced and sliced.object, settings, cancelled))

    def program(self, script):
        path = os.path.join(self.folder, "program")
        with open(path, "w") as file:
            file.write("#!/bin/sh\n" + script + "\n")
        os.chmod(path, stat.S_IRWXU)
        return path

    def writing(self, table, report):
        return self.program("printf '%s' > pack.csv\nprintf '%s' > pack.json" % (table, report))

    def stored(self, name, mode="rb"):
        with open(os.path.join(self.storage, name), mode) as file:
            return file.read()


class Interface(WithPlugin):
    def test_metadata_is_what_orca_reads(self):
        with open(PLUGIN, encoding="utf-8") as file:
            lines = file.read().splitlines()
        self.assertEqual(lines[0], "# /// script")
        block = "\n".join(line[2:] for line in lines[1 : lines.index("# ///")])
        try:
            import tomllib
        except ImportError:
            self.skipTest("no tomllib")
        metadata = tomllib.loads(block)
        self.assertEqual(metadata["dependencies"], ["numpy"])
        for name in ("name", "description", "version"):
            self.assertTrue(metadata["tool"]["orcaslicer"]["plugin"][name])

    def test_one_package_and_one_capability(self):
        self.assertEqual(len(self.host.packages), 1)
        self.assertTrue(issubclass(self.host.packages[0], stub.Base))
        self.assertEqual(self.host.capabilities, [self.plugin.AerateInfill])
        self.assertNotIn(";", self.capability.get_name())

    def test_default_configuration_is_a_dict_that_it_takes(self):
        default = self.capability.get_default_config()
        self.assertIsInstance(default, dict)
        self.assertEqual(self.plugin.checked_options(json.dumps(default)), default)
        self.assertEqual(self.plugin.checked_options("{}"), default)

    def test_other_steps_are_skipped(self):
        sliced = Sliced()
        before = sliced.state()
        for step in stub.Step:
            if step != stub.Step.posPrepareInfill:
                self.assertEqual(self.execute(sliced, step).status, stub.PluginResult.Skipped)
        self.assertEqual(self.execute(None).status, stub.PluginResult.Skipped)
        self.assertEqual(sliced.state(), before)
        self.assertEqual(self.host.processes, [])

    def test_standard_library_alone(self):
        with open(PLUGIN, encoding="utf-8") as file:
            lines = [line.strip() for line in file]
        imported = {line.split()[1] for line in lines if line.startswith(("import ", "from "))}
        self.assertLessEqual(imported - {"orca", "numpy"}, set(sys.stdlib_module_names))
        # NumPy is loaded for Orca, whose accessors hand out its arrays, and used nowhere.
        self.assertFalse([line for line in lines if "numpy." in line and not line.startswith("#")])


class Geometry(WithPlugin):
    def test_discs_are_those_of_a_sphere(self):
        for above in (-3.0, -2.9, -1.5, 0.0, 1.5, 2.999):
            expected = math.sqrt(9 - above * above)
            self.assertAlmostEqual(self.plugin.disc_radius(3.0, above), expected, places=12)
        self.assertEqual(self.plugin.disc_radius(3.0, 3.5), 0.0)
        self.assertEqual(self.plugin.disc_radius(3.0, -3.5), 0.0)

    def test_roofs(self):
        # 9.5 mm, 45 degrees, bridge 5: the cone leaves the ball at 6.717 and is cut at 10.935 (docs/packing.md).
        roof = (45.0, 5.0)
        self.assertAlmostEqual(self.plugin.disc_radius(9.5, 6.7, roof), math.sqrt(9.5**2 - 6.7**2))
        leaves = 9.5 * math.sin(math.radians(45))
        self.assertAlmostEqual(self.plugin.disc_radius(9.5, leaves + 1e-9, roof), leaves, places=6)
        self.assertAlmostEqual(self.plugin.disc_radius(9.5, leaves + 2, roof), leaves - 2, places=9)
        self.assertAlmostEqual(self.plugin.disc_radius(9.5, 10.93, roof), 2.5, delta=0.01)
        self.assertEqual(self.plugin.disc_radius(9.5, 10.94, roof), 0.0)
        # One that the bridge carries stays a ball.
        self.assertAlmostEqual(self.plugin.disc_radius(3.0, 2.9, roof), math.sqrt(9 - 2.9**2))

    def test_polygons_of_discs_are_inside_and_nearly_full(self):
        for radius in (0.2, 0.5, 2.0, 10.0, 25.0):
            polygon = self.plugin.disc(5.0, -3.0, radius)
            rounded = [(round(x / stub.UNIT) * stub.UNIT, round(y / stub.UNIT) * stub.UNIT) for x, y in polygon]
            self.assertTrue(all(math.hypot(x - 5, y + 3) <= radius for x, y in rounded))
            area = self.plugin.signed_area(polygon)
            self.assertLess(area, math.pi * radius * radius)
            self.assertGreater(area, math.pi * (radius - self.plugin.SAGITTA - 1e-4) ** 2 * 0.89)
            if radius >= 2:
                self.assertGreater(area, math.pi * (radius - self.plugin.SAGITTA) ** 2)

    def test_layers_of_a_known_packing(self):
        spheres = [(0.0, 0.0, 5.0, 3.0), (10.0, 0.0, 6.5, 1.0)]
        heights = [0.1 + 0.2 * k for k in range(60)]
        sections = self.plugin.sphere_sections(spheres, heights)
        for height, areas in zip(heights, sections):
            expected = sorted(
                math.sqrt(r * r - (height - z) ** 2)
                for _, _, z, r in spheres
                if abs(height - z) < r and math.sqrt(r * r - (height - z) ** 2) >= self.plugin.LEAST_DISC
            )
            found = sorted(math.sqrt(self.plugin.signed_area(contour) / math.pi) for contour, _ in areas)
            self.assertEqual(len(found), len(expected))
            for mine, wanted in zip(found, expected):
                self.assertLessEqual(mine, wanted)
                self.assertGreater(mine, wanted - 0.02)
        removed = sum(0.2 * self.plugin.signed_area(contour) for areas in sections for contour, _ in areas)
        whole = 4 / 3 * math.pi * (27 + 1)
        self.assertAlmostEqual(removed / whole, 1, delta=0.01)

    def test_spheres_with_roofs_have_the_volume_of_ball_and_cone(self):
        heights = [0.01 + 0.02 * k for k in range(1200)]
        sections = self.plugin.sphere_sections([(0.0, 0.0, 9.5, 9.5)], heights, (45.0, 5.0))
        removed = sum(0.02 * self.plugin.signed_area(contour) for areas in sections for contour, _ in areas)
        leaves = 9.5 * math.sin(math.radians(45))
        below = math.pi * (9.5**2 * (leaves + 9.5) - (leaves**3 + 9.5**3) / 3)
        rise = leaves - 2.5
        cone = math.pi * rise / 3 * (leaves**2 + leaves * 2.5 + 2.5**2)
        self.assertAlmostEqual(removed / (below + cone), 1, delta=0.003)

    def test_sections_of_a_mesh(self):
        vertices, triangles = globe(5.0)
        heights = [-4.5 + 0.5 * k for k in range(19)]  # through the equator's and others' corners
        for height, areas in zip(heights, self.plugin.mesh_sections(vertices, triangles, heights)):
            ((contour, holes),) = areas
            self.assertEqual(holes, [])
            self.assertAlmostEqual(self.plugin.signed_area(contour) / (math.pi * (25 - height**2)), 1, delta=0.01)

    def test_sections_with_holes_and_of_several_shells(self):
        outer, inner, other = box_mesh(0, 0, 0, 10, 10, 10), box_mesh(3, 3, 3, 7, 7, 7), box_mesh(4, 4, 4, 6, 6, 6)
        inner = (inner[0], [(u, w, v) for u, v, w in inner[1]])
        far = box_mesh(20, 0, 0, 22, 2, 5)
        mesh = self.plugin.joined([outer, inner, other, far])
        sections = self.plugin.mesh_sections(*mesh, [-1.0, 0.0, 1.0, 5.0, 10.0, 11.0])
        self.assertEqual([len(areas) for areas in sections], [0, 0, 2, 3, 1, 0])
        holed = sections[3][-1]
        self.assertAlmostEqual(self.plugin.signed_area(holed[0]), 100)
        self.assertEqual([self.plugin.signed_area(hole) for hole in holed[1]], [-16.0])

    def test_an_open_mesh_is_refused(self):
        vertices, triangles = box_mesh(0, 0, 0, 10, 10, 10)
        with self.assertRaises(self.plugin.Refused):
            self.plugin.mesh_sections(vertices, triangles[:-1], [5.0, 9.0])

    def test_stl_there_and_back(self):
        vertices, triangles = globe(5.0, 6)
        again = self.plugin.read_binary_stl(self.plugin.binary_stl(vertices, triangles))
        self.assertEqual(len(again[0]), len(vertices))
        self.assertAlmostEqual(volume(*again), volume(vertices, triangles), places=3)
        for data in (b"", b"x" * 50, bytes(84) + b"x", self.plugin.binary_stl(vertices, triangles)[:-1]):
            with self.assertRaises(self.plugin.Refused):
                self.plugin.read_binary_stl(data)

    def test_mirrored_meshes_still_face_outward(self):
        for matrix in (scaling(-1, 1, 1), times(scaling(1, 1, -2), turning(1, 40)), scaling(-1, -1, -1)):
            self.assertGreater(volume(*self.plugin.transformed(PRISM[0], PRISM[1], matrix)), 0)

    def test_walls_are_as_thick_as_the_perimeters(self):
        def wall(**values):
            return self.plugin.wall_of_perimeters(values.get)

        self.assertAlmostEqual(wall(wall_loops="3", outer_wall_line_width="0.42", inner_wall_line_width="0.45"), 1.32)
        self.assertAlmostEqual(wall(nozzle_diameter="0.6,0.6", wall_loops="2", line_width="110%"), 1.32)
        self.assertAlmostEqual(wall(nozzle_diameter="0.4", wall_loops="1", outer_wall_line_width="0"), 0.45)
        self.assertAlmostEqual(wall(), 0.9)


class Cutting(WithPlugin):
    def setUp(self):
        super().setUp()
        if PROGRAM is None:
            self.skipTest("no program was given")
        random.seed(7)

    def check_model(self, sliced):
        """What was packed is the mesh as it is printed, in the frame of the layers, facing outward."""
        vertices, triangles = self.plugin.read_binary_stl(self.stored("model.stl"))
        self.assertEqual(len(vertices), len(sliced.vertices))
        for p in sliced.vertices:
            self.assertLess(min(math.dist(p, q) for q in vertices), 1e-4)
        self.assertAlmostEqual(volume(vertices, triangles) / abs(volume(sliced.vertices, PRISM[1])), 1, places=5)

    def check_cut(self, sliced, before, is_inside):
        """Points of the sparse infill are left out just where they are inside of what was packed."""
        hits = misses = 0
        for at, layer in enumerate(sliced.layers):
            region = layer.regions()[0]
            top, was = before[at][0], before[at][-1]
            now = [surface for surface in region.fill_surfaces.surfaces]
            self.assertEqual(now[0].surface_type, stub.SurfaceType.stTop)
            self.assertEqual(now[0].expolygon.rings(), top[1])
            if was[0] != stub.SurfaceType.stInternal:
                self.assertEqual([s.expolygon.rings() for s in now[1:]], [was[1]])
                continue
            for surface in now[1:]:
                self.assertEqual(surface.surface_type, stub.SurfaceType.stInternal)
                self.assertEqual((surface.thickness, surface.bridge_angle, surface.hidden), (was[2], was[3], at))
            whole = stub.ExPolygon(stub._polygon(was[1][0]))
            x0, y0, x1, y1 = (c * stub.UNIT for c in whole.box())
            for _ in range(60):
                x, y = random.uniform(x0, x1), random.uniform(y0, y1)
                inside = is_inside(x, y, layer.slice_z)
                if inside is None or not whole.contains_mm(x, y):
                    continue
                is_left = any(surface.expolygon.contains_mm(x, y) for surface in now[1:])
                self.assertEqual(is_left, not inside, (x, y, layer.slice_z))
                hits += inside
                misses += not inside
        self.assertGreater(hits, 50)
        self.assertGreater(misses, 50)

    def inside_spheres(self, roof=None):
        spheres = self.plugin.read_spheres(self.stored("pack.csv", "r"))

        def is_inside(x, y, z):
            near = False
            for sx, sy, sz, radius in spheres:
                across = self.plugin.disc_radius(radius, z - sz, roof)
                depth = across - math.hypot(x - sx, y - sy)
                if across and depth > 0.02 and across > 0.25:
                    return True
                near = near or abs(depth) <= 0.02 or (depth > 0 and across)
            return None if near else False

        return is_inside

    def test_spheres_of_any_turn_and_scale(self):
        for name, matrix, turn in (
            ("as it is", IDENTITY, 0.0),
            ("turned", times(turning(2, 37), turning(0, 90)), 0.0),
            ("mirrored", scaling(-1, 1, 1), 0.0),
            ("scaled", times(turning(1, 20), scaling(1.2, 0.8, 1.1)), 0.0),
            ("second instance", turning(2, 10), 55.0),
        ):
            with self.subTest(name):
                self.options(shape="spheres", bridge=1000, overhang=45, max_radius=6)
                sliced = Sliced(matrix=matrix, turn=turn)
                before = sliced.state()
                result = self.execute(sliced)
                self.assertEqual(result.status, stub.PluginResult.Success, result.message)
                self.assertIn("left out", result.message)
                self.check_model(sliced)
                self.check_cut(sliced, before, self.inside_spheres())

    def test_area_of_discs_within_the_infill(self):
        self.options(shape="spheres", wall=3.5, bridge=1000, overhang=45)
        sliced = Sliced()
        before = sliced.state()
        self.assertEqual(self.execute(sliced).status, stub.PluginResult.Success)
        spheres = self.plugin.read_spheres(self.stored("pack.csv", "r"))
        removed = wanted = 0.0
        for at, layer in enumerate(sliced.layers):
            was = before[at][-1]
            if was[0] != stub.SurfaceType.stInternal:
                continue
            whole = stub.ExPolygon(stub._polygon(was[1][0])).area()
            now = sum(surface.area() for surface in layer.regions()[0].fill_surfaces.surfaces[1:])
            removed += (whole - now) * stub.UNIT**2
            radii = [self.plugin.disc_radius(r, layer.slice_z - z) for _, _, z, r in spheres]
            wanted += sum(math.pi * r * r for r in radii if r >= self.plugin.LEAST_DISC)
        self.assertGreater(wanted, 100)
        self.assertLessEqual(removed, wanted)
        self.assertGreater(removed, 0.985 * wanted)

    def test_roofs_are_cut_as_they_were_packed(self):
        self.options(shape="spheres", bridge=2)
        sliced = Sliced()
        before = sliced.state()
        self.assertEqual(self.execute(sliced).status, stub.PluginResult.Success)
        roof = self.plugin.read_roof(self.stored("pack.json"))
        self.assertEqual(roof[1], 2.0)
        self.check_cut(sliced, before, self.inside_spheres(roof))

    def test_cells(self):
        self.options()
        sliced = Sliced(matrix=times(turning(2, 25), scaling(1.2, 1, 1)))
        before = sliced.state()
        result = self.execute(sliced)
        self.assertEqual(result.status, stub.PluginResult.Success, result.message)
        self.check_model(sliced)
        cells = self.plugin.read_binary_stl(self.stored("pack.stl"))
        heights = [layer.slice_z for layer in sliced.layers]
        crossings = dict(zip(heights, self.plugin.crossings(*cells, heights)))

        def is_inside(x, y, z):  # by the turns of the outline's pieces round the point
            turns = 0.0
            for _, (x0, y0), _, (x1, y1) in crossings[z]:
                if min(math.hypot(x0 - x, y0 - y), math.hypot(x1 - x, y1 - y)) < 0.1:
                    return None
                angle = math.atan2(y1 - y, x1 - x) - math.atan2(y0 - y, x0 - x)
                turns += (angle + math.pi) % (2 * math.pi) - math.pi
            turns = round(turns / (2 * math.pi))
            self.assertIn(turns, (0, 1))
            return turns == 1

        self.check_cut(sliced, before, is_inside)
        # All layers of the cells together have their volume.
        fine = [0.05 + 0.1 * k for k in range(190)]
        summed = sum(
            0.1 * (self.plugin.signed_area(contour) + sum(map(self.plugin.signed_area, holes)))
            for areas in self.plugin.mesh_sections(*cells, fine)
            for contour, holes in areas
        )
        self.assertAlmostEqual(summed / volume(*cells), 1, delta=0.01)
        packed = json.loads(self.stored("pack.json"))["cells"]["pieces"]
        self.assertAlmostEqual(summed / packed["volume_mm3"], 1, delta=0.01)

    def test_several_objects_and_one_again(self):
        self.options(shape="spheres")
        objects = [Sliced(), Sliced(matrix=scaling(1, 1, 1.5), name="tall"), Sliced(name="copy")]
        states = [sliced.state() for sliced in objects]
        for sliced in objects:
            self.assertEqual(self.execute(sliced).status, stub.PluginResult.Success)
        self.assertNotEqual(objects[0].state(), states[0])
        self.assertNotEqual(objects[1].state(), states[1])
        # The same mesh under the same options is packed once.
        self.assertEqual(objects[0].state(), objects[2].state())
        self.assertEqual(len(self.host.processes), 2)
        again = Sliced()
        self.options(shape="spheres", gap=1.5)
        self.assertEqual(self.execute(again).status, stub.PluginResult.Success)
        self.assertEqual(len(self.host.processes), 3)
        self.assertNotEqual(again.state(), objects[0].state())
        # Orca asks about each new command line: there is one for spheres, one for cells.
        self.assertEqual(len(set(self.host.processes)), 1)

    def test_the_wall_is_that_of_the_perimeters(self):
        self.options(shape="spheres")
        self.execute(Sliced())
        self.assertIn("wall = 0.87\n", self.stored("pack.toml", "r"))

    def test_regions_of_another_density_stay(self):
        self.options(shape="spheres")
        sliced = Sliced(more=[{"sparse_infill_density": "60%"}])
        before = sliced.state()
        self.assertEqual(self.execute(sliced).status, stub.PluginResult.Success)
        after = sliced.state()
        self.assertEqual(after[1::2], before[1::2])
        self.assertNotEqual(after[0::2], before[0::2])

    def test_negative_volumes_stay_solid_around(self):
        self.options(shape="spheres", bridge=1000, overhang=45)
        sliced = Sliced()
        hole = box_mesh(5, 5, -1, 9, 9, 19)
        sliced.model._volumes.append(stub.ModelVolume(hole, IDENTITY, "negative"))
        sliced.model._volumes.append(stub.ModelVolume(box_mesh(0, 0, 0, 1, 1, 1), IDENTITY, "blocker"))
        self.assertEqual(self.execute(sliced).status, stub.PluginResult.Success)
        spheres = self.plugin.read_spheres(self.stored("pack.csv", "r"))
        self.assertGreater(len(spheres), 1)
        for x, y, _, radius in spheres:
            x, y = x + sliced.centre[0], y + sliced.centre[1]
            away = math.hypot(max(5 - x, 0, x - 9), max(5 - y, 0, y - 9))
            self.assertGreater(away - radius, 0.86)

    def test_nothing_fits(self):
        self.options(shape="spheres", wall=8)
        sliced = Sliced()
        before = sliced.state()
        result = self.execute(sliced)
        self.assertEqual(result.status, stub.PluginResult.Skipped)
        self.assertIn("nothing to remove", result.message)
        self.assertEqual(sliced.state(), before)


class Failing(WithPlugin):
    """Whatever cannot be done leaves the print as it is, and says why."""

    def check(self, sliced, reason, status=stub.PluginResult.Skipped):
        before = sliced.state()
        result = self.execute(sliced)
        self.assertEqual(result.status, status, result.message)
        self.assertIn("prism: nothing left out: ", result.message)
        self.assertIn(reason, result.message)
        self.assertEqual(sliced.state(), before)
        self.assertIn(result.message, self.stored("aerate.log", "r"))

    def test_no_program(self):
        self.options(program=os.path.join(self.folder, "none"))
        self.check(Sliced(), "cannot be run")

    def test_the_user_says_no(self):
        self.options(program=self.program("exit 0"))
        self.host.allows_processes = False
        self.check(Sliced(), "not allowed")

    def test_the_program_fails(self):
        self.options(program=self.program("echo 'aerate: error: the disk is full' >&2\nexit 1"))
        self.check(Sliced(), "the disk is full")
        self.options(program=self.program("kill -9 $$"))
        self.check(Sliced(), "exit status -9")

    def test_the_program_writes_rubbish(self):
        for files in ("", "echo x > pack.stl", "echo x > pack.stl; echo '{}' > pack.json"):
            self.options(program=self.program(files))
            self.check(Sliced(), "")
        for table, report in (("x,y\n1,2", "{}"), ("x,y,z,radius,kind\n1,2,3,-1,a", "{}"), ("x,y,z,radius", "[]")):
            self.options(program=self.writing(table.replace("\n", "\\n"), report), shape="spheres")
            self.check(Sliced(), "cannot be read")

    def test_it_takes_too_long(self):
        self.options(program=self.program("exec sleep 30"), max_seconds=0.3)
        start = time.monotonic()
        self.check(Sliced(), "more than 0.3 s")
        self.assertLess(time.monotonic() - start, 10)

    def test_strict_stops_the_slicing(self):
        self.options(program=os.path.join(self.folder, "none"), strict=True)
        self.check(Sliced(), "cannot be run", stub.PluginResult.FatalError)

    def test_wrong_options(self):
        for options, reason in (
            ({"wal": 1}, "unknown options: wal"),
            ({"wall": -1}, '"wall" is neither'),
            ({"gap": "1"}, '"gap" is neither'),
            ({"gap": True}, '"gap" is neither'),
            ({"shape": "cubes"}, '"shape" is neither'),
            ({"max_voids": 1.5}, '"max_voids" is neither'),
            ({"max_seconds": None}, '"max_seconds" is no number'),
            ({"enabled": 1}, '"enabled" is neither'),
            ({"program": ""}, '"program" is no path'),
            ({"shape": "spheres", "cell_size": 9}, '"cell_size" is for cells'),
        ):
            self.capability.saved = json.dumps(options)
            self.check(Sliced(), reason)
        for text, reason in (("{", "no JSON"), ("[]", "no JSON object"), ('{"wall": NaN}', '"wall" is neither')):
            self.capability.saved = text
            self.check(Sliced(), reason)

    def test_layers_that_are_elsewhere(self):
        self.options()
        sliced = Sliced()
        x0, y0, x1, y1 = sliced.object._box
        sliced.object._box = (x0 + 2000000, y0, x1 + 2000000, y1)
        self.check(sliced, "not where its mesh is")
        turned = Sliced()
        turned.object._trafo = times(turning(2, 90), turned.object._trafo)
        self.check(turned, "not where its mesh is")
        grown = Sliced()
        grown.object._trafo = times(scaling(1.1, 1.1, 1), grown.object._trafo)
        self.check(grown, "not where its mesh is")

    def test_layers_that_a_negative_volume_cut(self):
        mesh = box_mesh(-5, -5, 0, 5, 5, 10)
        layers = [(z, (-5.0, -5.0, 2.0, 5.0)) for z in (1.0, 5.0, 9.0)]
        self.assertTrue(self.plugin.fits(*mesh, layers, True))
        self.assertFalse(self.plugin.fits(*mesh, layers, False))
        self.assertFalse(self.plugin.fits(*mesh, [(z, (-7.0, -5.0, 2.0, 5.0)) for z, _ in layers], True))
        self.assertFalse(self.plugin.fits(*mesh, [], True))

    def test_a_mesh_that_is_none(self):
        self.options()
        empty = Sliced()
        empty.model._volumes = []
        self.check(empty, "no mesh")
        flat = Sliced()
        flat.object._trafo = times(scaling(1, 1, 0), flat.object._trafo)
        self.check(flat, "")

    def test_orca_refuses_a_layer(self):
        spheres = "x,y,z,radius,kind\\n0,0,9,5,adaptive\\n"
        report = '{"limits": {"overhang_degrees": null, "bridge_mm": null}}'
        self.options(program=self.writing(spheres, report), shape="spheres")
        sliced = Sliced()
        sliced.layers[20].regions()[0].fill_surfaces.refuses = True
        self.check(sliced, "RuntimeError: refused")
        # And the same layers can be cut.
        self.assertEqual(self.execute(Sliced()).status, stub.PluginResult.Success)

    def test_what_is_swallowed_whole_goes(self):
        spheres = "x,y,z,radius,kind\\n0,0,9,99,adaptive\\n"
        report = '{"limits": {"overhang_degrees": null, "bridge_mm": null}}'
        self.options(program=self.writing(spheres, report), shape="spheres")
        sliced = Sliced()
        result = self.execute(sliced)
        self.assertIn("100.0 % of the sparse infill left out", result.message)
        for layer in sliced.layers:
            self.assertFalse(layer.regions()[0].fill_surfaces.has(stub.SurfaceType.stInternal))

    def test_nothing_to_cut(self):
        for sliced in (Sliced(density="0%"), Sliced(density="100%")):
            before = sliced.state()
            self.options(program=os.path.join(self.folder, "none"))
            result = self.execute(sliced)
            self.assertIn("no sparse infill", result.message)
            self.assertEqual(sliced.state(), before)
        self.options(program=os.path.join(self.folder, "none"), enabled=False)
        self.assertEqual(self.execute(Sliced()).message, "")
        self.assertEqual(self.host.processes, [])

    def test_cancelling(self):
        sliced = Sliced()
        before = sliced.state()
        cancelled = threading.Event()
        mark = os.path.join(self.folder, "ended")
        # The program may be a script: what it has started ends as well.
        self.options(program=self.program("(sleep 1.5; touch %s) &\nsleep 30" % mark))
        timer = threading.Timer(0.4, cancelled.set)
        timer.start()
        self.addCleanup(timer.join)
        start = time.monotonic()
        result = self.execute(sliced, cancelled=cancelled.is_set)
        self.assertLess(time.monotonic() - start, 10)
        self.assertEqual((result.status, result.message), (stub.PluginResult.Skipped, "cancelled"))
        self.assertEqual(sliced.state(), before)
        time.sleep(1.5)
        self.assertFalse(os.path.exists(mark))

    def test_cancelling_at_any_question(self):
        spheres = "x,y,z,radius,kind\\n0,0,9,5,adaptive\\n"
        report = '{"limits": {"overhang_degrees": null, "bridge_mm": null}}'
        self.options(program=self.writing(spheres, report), shape="spheres")
        questions = []
        self.execute(Sliced(), cancelled=lambda: bool(questions.append(1)))
        for at in range(0, len(questions), 5):
            sliced = Sliced()
            before = sliced.state()
            asked = []

            def cancelled():
                asked.append(1)
                return len(asked) > at

            self.assertEqual(self.execute(sliced, cancelled=cancelled).message, "cancelled")
            self.assertEqual(sliced.state(), before)

    def test_a_log_that_cannot_be_written(self):
        os.mkdir(os.path.join(self.storage, "aerate.log"))
        self.options(program=os.path.join(self.folder, "none"))
        sliced = Sliced()
        before = sliced.state()
        self.assertIn("cannot be run", self.execute(sliced).message)
        self.assertEqual(sliced.state(), before)


if __name__ == "__main__":
    if len(sys.argv) > 1 and not sys.argv[1].startswith("-"):
        PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()

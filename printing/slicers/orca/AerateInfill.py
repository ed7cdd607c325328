# /// script
# requires-python = ">=3.11"
# dependencies = ["numpy"]
#
# [tool.orcaslicer.plugin]
# name = "Aerate Infill"
# description = "Leaves out sparse infill in the cells or spheres that aerate packs into each object."
# author = "aerate"
# version = "0.1.0"
# ///
"""Plugin for OrcaSlicer's slicing pipeline: no sparse infill where aerate packs voids (docs/slicers.md).

When an object's infill has been prepared, its mesh, turned and scaled as it is printed, goes through `aerate pack`, and
the cross-sections of what was packed are cut out of the sparse infill of each layer, as a modifier of 0 % would do.
Perimeters and solid infill stay as they are. Whatever cannot be done leaves the print as it was, and is said in Orca's
log and in aerate.log in the plugin's folder.

Lengths are mm unless they are called scaled, which is Orca's unit of polygons.
"""

import array
import bisect
import collections
import csv
import hashlib
import json
import math
import os
import signal
import subprocess
import sys
import threading
import time

import orca

# Orca hands out matrices and meshes as NumPy's arrays. It has to be loaded here: within a call Orca asks the user about
# every file that is read. Nothing here uses it.
try:
    import numpy  # noqa: F401
except ImportError:
    pass

DEFAULTS = {
    "enabled": True,
    "program": "aerate",  # its path, or its name if it is on the PATH
    "shape": "cells",  # or "spheres"
    "wall": None,  # null: as thick as the perimeters
    "gap": None,  # this and what follows, null: the default of aerate pack
    "min_radius": None,
    "max_radius": None,
    "cell_size": None,
    "overhang": None,
    "bridge": None,
    "max_voids": None,
    "max_seconds": 600,
    "strict": False,  # true: what cannot be done stops the slicing with a message
}
# Options of aerate pack, by their names here.
LENGTHS = {
    "wall": "wall",
    "gap": "gap",
    "min_radius": "min-radius",
    "max_radius": "max-radius",
    "cell_size": "cell-size",
    "overhang": "overhang",
    "bridge": "bridge",
}
# Of spheres: smaller ones cost time and save nothing.
LEAST_SPHERE = 1.5
# Discs and holes that no line of infill would notice.
LEAST_DISC = 0.2
LEAST_AREA = 0.05
# How far the polygon of a disc stays inside of it.
SAGITTA = 0.01
# How far the outline of a layer may be from the mesh's (compensations, closing of gaps).
OUTLINE_TOLERANCE = 0.8
PROBED_LAYERS = 9
KEPT_PACKINGS = 16
LARGEST_LOG = 200000


class Refused(Exception):
    """What cannot be done, in a sentence; the print stays as it is."""


class Cancelled(Exception):
    pass


# Meshes: vertices are tuples of three floats, triangles of three indices.


def rows(values):
    """The rows of a NumPy array or of a list, as a list."""
    return values.tolist() if hasattr(values, "tolist") else [list(row) for row in values]


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def determinant(m):
    return (
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
        - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    )


def linear_inverse(m):
    """Of the upper left 3 x 3. Raises Refused if it is flat."""
    whole = determinant(m)
    if not math.isfinite(whole) or whole == 0:
        raise Refused("the object's transform is flat or not finite")

    def cofactor(i, j):
        a, b = [k for k in range(3) if k != i]
        c, d = [k for k in range(3) if k != j]
        return (-1) ** (i + j) * (m[a][c] * m[b][d] - m[a][d] * m[b][c])

    return [[cofactor(j, i) / whole for j in range(3)] for i in range(3)]


def transformed(vertices, triangles, matrix):
    """The mesh after the matrix; facing outward still if the matrix mirrors."""
    (a, b, c, p), (d, e, f, q), (g, h, i, r) = matrix[:3]
    moved = [(a * x + b * y + c * z + p, d * x + e * y + f * z + q, g * x + h * y + i * z + r) for x, y, z in vertices]
    if determinant(matrix) < 0:
        return moved, [(u, w, v) for u, v, w in triangles]
    return moved, [tuple(triangle) for triangle in triangles]


def joined(meshes):
    vertices, triangles = [], []
    for some, of_them in meshes:
        first = len(vertices)
        vertices += some
        triangles += [(u + first, v + first, w + first) for u, v, w in of_them]
    return vertices, triangles


def box_centre(vertices):
    """Of the bounding box, in x and y."""
    return tuple((min(v[k] for v in vertices) + max(v[k] for v in vertices)) / 2 for k in range(2))


def shifted(vertices, x, y):
    return [(v[0] + x, v[1] + y, v[2]) for v in vertices]


def binary_stl(vertices, triangles):
    numbers = array.array("f")
    for triangle in triangles:
        numbers.extend((0.0, 0.0, 0.0))
        for index in triangle:
            numbers.extend(vertices[index])
    if sys.byteorder == "big":
        numbers.byteswap()
    data = numbers.tobytes()
    records = b"\0\0".join(data[at : at + 48] for at in range(0, len(data), 48))
    return bytes(80) + len(triangles).to_bytes(4, "little") + records + (b"\0\0" if triangles else b"")


def read_binary_stl(data):
    """The mesh of a binary STL, vertices of the same coordinates joined. Raises Refused if it is none."""
    count = int.from_bytes(data[80:84], "little")
    if len(data) < 84 or len(data) != 84 + 50 * count:
        raise Refused("the file of cells is no binary STL")
    numbers = array.array("f")
    numbers.frombytes(b"".join(data[at + 12 : at + 48] for at in range(84, len(data), 50)))
    if sys.byteorder == "big":
        numbers.byteswap()
    index_of = {}
    corners = [
        index_of.setdefault((numbers[at] + 0.0, numbers[at + 1] + 0.0, numbers[at + 2] + 0.0), len(index_of))
        for at in range(0, len(numbers), 3)
    ]
    triangles = [(corners[at], corners[at + 1], corners[at + 2]) for at in range(0, len(corners), 3)]
    return list(index_of), triangles


# Cross-sections: a polygon is a list of points (x, y); an area is a contour, counter-clockwise, and its holes.


def never():
    return False


def check(cancelled):
    if cancelled():
        raise Cancelled()


def crossings(vertices, triangles, heights, cancelled=never):
    """For each height, which ascend: pieces of the mesh's outline there, each (edge, point, next edge, its point).

    Solid is on the left. A vertex at just that height counts as above it, so the pieces of a closed mesh always make
    closed outlines.
    """
    found = [[] for _ in heights]
    for number, (u, v, w) in enumerate(triangles):
        if number % 4096 == 0:
            check(cancelled)
        zs = (vertices[u][2], vertices[v][2], vertices[w][2])
        first, last = bisect.bisect_right(heights, min(zs)), bisect.bisect_right(heights, max(zs))
        for k in range(first, last):
            height = heights[k]
            down = up = None
            for a, b in ((u, v), (v, w), (w, u)):
                above_a, above_b = vertices[a][2] >= height, vertices[b][2] >= height
                if above_a == above_b:
                    continue
                # From the same end on both sides of an edge, so that both find the same point.
                p, q = (vertices[a], vertices[b]) if a < b else (vertices[b], vertices[a])
                t = (height - p[2]) / (q[2] - p[2])
                crossing = ((min(a, b), max(a, b)), (p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])))
                if above_b:
                    up = crossing
                else:
                    down = crossing
            if down and up:
                found[k].append(down + up)
    return found


def signed_area(polygon):
    return sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in zip(polygon, polygon[1:] + polygon[:1])) / 2


def contains(polygon, point):
    x, y = point
    inside = False
    for (x0, y0), (x1, y1) in zip(polygon, polygon[1:] + polygon[:1]):
        if (y0 > y) != (y1 > y) and x < x0 + (y - y0) / (y1 - y0) * (x1 - x0):
            inside = not inside
    return inside


def outlines(pieces):
    """The closed polygons that the pieces of `crossings` make. Raises Refused if they do not close."""
    after = {}
    for edge, point, next_edge, _ in pieces:
        after.setdefault(edge, []).append((point, next_edge))
    polygons = []
    while after:
        start = edge = next(iter(after))
        polygon = []
        while True:
            if edge not in after:
                raise Refused("the cells are not closed")
            point, following = after[edge].pop()
            if not after[edge]:
                del after[edge]
            polygon.append(point)
            edge = following
            if edge == start:
                break
        polygons.append(polygon)
    return polygons


def areas(polygons):
    """Contours with their holes, by orientation; what is too small for a line is left out."""
    sized = [(signed_area(polygon), polygon) for polygon in polygons]
    contours = sorted([(area, polygon, []) for area, polygon in sized if area >= LEAST_AREA], key=lambda c: c[0])
    for area, hole in sized:
        if area <= -LEAST_AREA:
            for _, contour, holes in contours:  # the smallest that it lies in
                if contains(contour, hole[0]):
                    holes.append(hole)
                    break
    return [(contour, holes) for _, contour, holes in contours]


def mesh_sections(vertices, triangles, heights, cancelled=never):
    """For each height, which ascend, the areas of the mesh there."""
    found = []
    for pieces in crossings(vertices, triangles, heights, cancelled):
        check(cancelled)
        found.append(areas(outlines(pieces)))
    return found


def disc_radius(radius, above, roof=None):
    """Of a sphere's cross-section so far above its centre, 0 where there is none.

    roof is (overhang in degrees, bridge) or None: a sphere wider than the bridge allows goes on as a cone that leans by
    the overhang angle, cut flat where it is as wide as the bridge (docs/packing.md).
    """
    if roof:
        lean, half = math.radians(roof[0]), roof[1] / 2
        if radius * math.cos(lean) > half and above > radius * math.sin(lean):
            across = (radius - above * math.sin(lean)) / math.cos(lean)
            return across if across >= half else 0.0
    return math.sqrt(radius * radius - above * above) if abs(above) < radius else 0.0


def disc(x, y, radius):
    """A polygon inside the circle, its corners on it but for rounding, counter-clockwise."""
    radius -= 1e-5  # Orca's coordinates are whole numbers of 1e-6 mm, or 1e-5 for large beds
    corners = 8
    if SAGITTA < radius:
        corners = max(corners, math.ceil(math.pi / math.acos(1 - SAGITTA / radius)))
    step = 2 * math.pi / corners
    return [(x + radius * math.cos(k * step), y + radius * math.sin(k * step)) for k in range(corners)]


def sphere_sections(spheres, heights, roof=None, cancelled=never):
    """For each height, which ascend, the areas of spheres (x, y, z, radius) there."""
    found = [[] for _ in heights]
    for x, y, z, radius in spheres:
        check(cancelled)
        # A roof's top is below (radius - half cos) / sin, so below this.
        reach = radius / math.sin(math.radians(roof[0])) if roof else radius
        for k in range(bisect.bisect_left(heights, z - radius), bisect.bisect_right(heights, z + reach)):
            across = disc_radius(radius, heights[k] - z, roof)
            if across >= LEAST_DISC:
                found[k].append((disc(x, y, across), []))
    return found


# What is asked of aerate, and what it answers.


def checked_options(text):
    """The options from the text of Orca's configuration. Raises Refused."""
    try:
        given = json.loads(text or "{}")
    except ValueError as error:
        raise Refused("the configuration is no JSON: %s" % error) from None
    if not isinstance(given, dict):
        raise Refused("the configuration is no JSON object")
    unknown = sorted(set(given) - set(DEFAULTS))
    if unknown:
        raise Refused("the configuration has unknown options: %s" % ", ".join(unknown))
    options = dict(DEFAULTS, **given)

    def is_positive(value):
        return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value) and value > 0

    for name in ("enabled", "strict"):
        if not isinstance(options[name], bool):
            raise Refused('"%s" is neither true nor false' % name)
    if not isinstance(options["program"], str) or not options["program"]:
        raise Refused('"program" is no path')
    if options["shape"] not in ("cells", "spheres"):
        raise Refused('"shape" is neither "cells" nor "spheres"')
    for name in LENGTHS:
        if options[name] is not None and not is_positive(options[name]):
            raise Refused('"%s" is neither a number above 0 nor null' % name)
    if not is_positive(options["max_seconds"]):
        raise Refused('"max_seconds" is no number above 0')
    voids = options["max_voids"]
    if voids is not None and (not is_positive(voids) or voids != int(voids)):
        raise Refused('"max_voids" is neither a whole number above 0 nor null')
    if options["shape"] == "spheres" and options["cell_size"] is not None:
        raise Refused('"cell_size" is for cells')
    return options


def settings_file(options, wall, has_solid):
    """The text of a configuration file for aerate pack: the command line stays the same whatever the options."""
    lines = ["[pack]", 'shape = "%s"' % options["shape"]]
    values = dict(options, wall=options["wall"] or wall)
    if options["shape"] == "spheres" and options["min_radius"] is None:
        largest = options["max_radius"]
        values["min_radius"] = LEAST_SPHERE if largest is None else min(LEAST_SPHERE, largest)
    for name, option in LENGTHS.items():
        if values[name] is not None:
            lines.append("%s = %.9g" % (option, values[name]))
    if options["max_voids"] is not None:
        lines.append("max-voids = %d" % options["max_voids"])
    if has_solid:
        lines.append('keep-solid = ["solid.stl"]')
    return "\n".join(lines) + "\n"


def width_of_lines(text, nozzle):
    """Of Orca's setting: mm, or percent of the nozzle; None if it is 0, which leaves it to Orca, or nothing."""
    try:
        number = float(text.rstrip("%"))
    except (AttributeError, ValueError):
        return None
    if not math.isfinite(number) or number <= 0:
        return None
    return number / 100 * nozzle if text.endswith("%") else number


def wall_of_perimeters(value):
    """How thick the perimeters are; `value` gives a setting by its name, as text or None."""
    try:
        nozzle = float((value("nozzle_diameter") or "").replace(";", ",").split(",")[0])
    except ValueError:
        nozzle = 0.4
    usual = width_of_lines(value("line_width"), nozzle) or 1.125 * nozzle
    outer = width_of_lines(value("outer_wall_line_width"), nozzle) or usual
    inner = width_of_lines(value("inner_wall_line_width"), nozzle) or usual
    try:
        loops = int(float(value("wall_loops")))
    except (TypeError, ValueError):
        loops = 2
    return outer + max(0, loops - 1) * inner


def percent(text):
    """Of a setting such as "15%"; None if it is none."""
    try:
        return float(text.rstrip("%"))
    except (AttributeError, ValueError):
        return None


def read_spheres(text):
    """Spheres (x, y, z, radius) of the table that aerate pack writes. Raises Refused."""
    spheres = []
    try:
        for row in csv.DictReader(text.splitlines()):
            sphere = tuple(float(row[name]) for name in ("x", "y", "z", "radius"))
            if not all(math.isfinite(number) for number in sphere) or sphere[3] <= 0:
                raise ValueError
            spheres.append(sphere)
    except (KeyError, TypeError, ValueError):
        raise Refused("the table of spheres cannot be read") from None
    return spheres


def read_roof(text):
    """(overhang, bridge) of aerate pack's report, None where ceilings are not limited. Raises Refused."""
    try:
        limits = json.loads(text)["limits"]
        overhang, bridge = limits.get("overhang_degrees"), limits.get("bridge_mm")
        if overhang is None or bridge is None:
            return None
        return float(overhang), float(bridge)
    except (AttributeError, KeyError, TypeError, ValueError):
        raise Refused("the report of aerate cannot be read") from None


class Packing:
    """What aerate packed: a mesh of cells, or spheres and their roof."""

    def __init__(self, cells=None, spheres=None, roof=None):
        self.cells = cells
        self.spheres = spheres
        self.roof = roof

    def sections(self, heights, cancelled):
        if self.cells:
            return mesh_sections(self.cells[0], self.cells[1], heights, cancelled)
        return sphere_sections(self.spheres, heights, self.roof, cancelled)


def end_process(child):
    """And, where there are process groups, what it has started (the program may be a script)."""
    try:
        if hasattr(os, "killpg"):
            os.killpg(child.pid, signal.SIGKILL)
        else:
            child.kill()
    except OSError:  # it has just ended
        pass
    child.wait()
    for pipe in (child.stdin, child.stdout, child.stderr):
        pipe.close()


def run(command, folder, seconds, cancelled):
    """The exit status and what was written to standard error. Raises Refused or Cancelled."""
    hidden = getattr(subprocess, "CREATE_NO_WINDOW", 0)
    try:
        # Pipes alone: opening the null device would be one more question to the user.
        child = subprocess.Popen(
            command,
            cwd=folder,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            creationflags=hidden,
            start_new_session=True,
        )
    except (OSError, ValueError) as error:
        raise Refused("%s cannot be run: %s" % (command[0], error)) from None
    end = time.monotonic() + seconds
    try:
        while True:
            try:
                _, errors = child.communicate(timeout=0.1)
                return child.returncode, errors.decode("utf-8", "replace")
            except subprocess.TimeoutExpired:
                pass
            check(cancelled)
            if time.monotonic() > end:
                raise Refused("aerate took more than %g s" % seconds)
    finally:
        if child.poll() is None:
            end_process(child)


def pack(options, wall, model, solid, folder, cancelled):
    """Runs aerate pack on an STL, `solid` being an STL of what stays solid, or None. Raises Refused or Cancelled."""
    name = "pack.stl" if options["shape"] == "cells" else "pack.csv"
    files = {"model.stl": model, "pack.toml": settings_file(options, wall, solid is not None).encode()}
    if solid is not None:
        files["solid.stl"] = solid
    try:
        for file_name, content in files.items():
            with open(os.path.join(folder, file_name), "wb") as file:
                file.write(content)
    except OSError as error:
        raise Refused("the plugin's folder cannot be written: %s" % error) from None
    command = [os.path.expanduser(options["program"]), "--config", "pack.toml", "pack", "model.stl"]
    command += ["-o", name, "--json", "pack.json", "--quiet"]
    status, errors = run(command, folder, options["max_seconds"], cancelled)
    if status != 0:
        said = [line for line in errors.splitlines() if line.strip()]
        raise Refused(" ".join(said[:2]) if said else "aerate ended with exit status %d" % status)
    try:
        with open(os.path.join(folder, name), "rb") as file:
            packed = file.read()
        with open(os.path.join(folder, "pack.json"), "rb") as file:
            report = file.read()
    except OSError as error:
        raise Refused("what aerate wrote cannot be read: %s" % error) from None
    if options["shape"] == "cells":
        return Packing(cells=read_binary_stl(packed))
    return Packing(spheres=read_spheres(packed.decode("utf-8", "replace")), roof=read_roof(report))


class Packings:
    """Packings by what they were made of, the last few."""

    def __init__(self):
        self._kept = collections.OrderedDict()
        self._lock = threading.Lock()  # the files of a run have the same names each time

    def get(self, options, wall, model, solid, folder, cancelled):
        text = settings_file(options, wall, solid is not None) + options["program"]
        key = hashlib.sha256(b"\0".join([text.encode(), model, solid or b""])).digest()
        with self._lock:
            if key not in self._kept:
                self._kept[key] = pack(options, wall, model, solid, folder, cancelled)
                if len(self._kept) > KEPT_PACKINGS:
                    self._kept.popitem(last=False)
            self._kept.move_to_end(key)
            return self._kept[key]


# Orca's objects. References into its layers hold only while a call runs, and until their list is replaced.


def meshes_of(model_object, matrix, wanted):
    """One mesh of the volumes that are wanted, after the matrix and their own."""
    meshes = []
    for volume in model_object.volumes():
        if wanted(volume):
            mesh = volume.mesh()
            whole = product(matrix, rows(volume.matrix()))
            meshes.append(transformed(rows(mesh.vertices()), rows(mesh.triangles()), whole))
    return joined(meshes)


def fits(vertices, triangles, outlines_of_layers, is_cut):
    """Is the mesh where the layers are? These are (height, box of the outline), heights ascending.

    Negative volumes may have cut the layers (is_cut): these are smaller then.
    """
    heights = [height for height, _ in outlines_of_layers]
    fitting = 0
    for pieces, (_, box) in zip(crossings(vertices, triangles, heights), outlines_of_layers):
        points = [piece[1] for piece in pieces]
        if points:
            mine = (
                min(p[0] for p in points),
                min(p[1] for p in points),
                max(p[0] for p in points),
                max(p[1] for p in points),
            )
            inward = (box[0] - mine[0], box[1] - mine[1], mine[2] - box[2], mine[3] - box[3])
            fitting += all(
                -OUTLINE_TOLERANCE <= depth and (is_cut or depth <= OUTLINE_TOLERANCE) for depth in inward
            )
    return 4 * fitting >= 3 * len(outlines_of_layers) and fitting > 0


def probed_outlines(layers, unit):
    """Height and box of the outline of some layers, spread over all."""
    filled = [layer for layer in layers if layer.lslices()]
    some = [filled[(2 * k + 1) * len(filled) // (2 * PROBED_LAYERS)] for k in range(PROBED_LAYERS)] if filled else []
    found = {}
    for layer in some:
        points = [point for island in layer.lslices() for point in island.contour.points]
        xs, ys = [point.x for point in points], [point.y for point in points]
        found[layer.slice_z] = tuple(number * unit for number in (min(xs), min(ys), max(xs), max(ys)))
    return sorted(found.items())


def placed_meshes(print_object, unit):
    """The parts and the negative volumes (or None) of an object in the frame of its layers. Raises Refused.

    Orca centres what it slices: the first instance's box without the instance's own place, turned as this one is.
    """
    model_object = print_object.model_object()
    trafo = rows(print_object.trafo())
    vertices, triangles = meshes_of(model_object, trafo, lambda volume: volume.is_model_part())
    if not triangles:
        raise Refused("the object has no mesh")
    if not all(math.isfinite(number) for vertex in vertices for number in vertex):
        raise Refused("the mesh has coordinates that are not finite")
    x0, y0, x1, y1 = print_object.bounding_box()
    middle = ((x0 + x1) * unit / 2, (y0 + y1) * unit / 2)
    centres = [box_centre(vertices)]
    if model_object.instance_count():
        first = rows(model_object.instance(0).matrix())
        still = [row[:3] + [0.0] for row in first[:3]] + [[0.0, 0.0, 0.0, 1.0]]
        if any(abs(still[i][j] - trafo[i][j]) > 1e-9 for i in range(3) for j in range(3)):
            back = linear_inverse(still)
            turn = [[sum(trafo[i][k] * back[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
            x, y = box_centre(meshes_of(model_object, still, lambda volume: volume.is_model_part())[0])
            centres.insert(0, (turn[0][0] * x + turn[0][1] * y, turn[1][0] * x + turn[1][1] * y))
    solid, solid_triangles = meshes_of(model_object, trafo, lambda volume: volume.is_negative_volume())
    probed = probed_outlines(print_object.layers(), unit)
    for centre in centres:
        shift = (middle[0] - centre[0], middle[1] - centre[1])
        placed = shifted(vertices, *shift)
        if fits(placed, triangles, probed, bool(solid_triangles)):
            return (placed, triangles), (shifted(solid, *shift), solid_triangles) if solid_triangles else None
    raise Refused("the object's layers are not where its mesh is")


def sparse_density(print_object, context):
    """Of the object, in percent; None if Orca does not say."""
    own = print_object.model_object().config_value("sparse_infill_density")
    return percent(own if own is not None else context.config_value("sparse_infill_density"))


def sparse_regions(print_object, density):
    """(layer, region) with sparse infill of the object's own density: other regions are modifiers of the user's."""
    found = []
    for layer in print_object.layers():
        for region in layer.regions():
            if region.fill_surfaces.has(orca.host.SurfaceType.stInternal):
                if percent(region.config_value("sparse_infill_density")) == density:
                    found.append((layer, region))
    return found


def host_polygon(points, unit):
    polygon = orca.host.Polygon()
    for x, y in points:
        polygon.append(orca.host.Point(round(x / unit), round(y / unit)))
    return polygon


def host_area(area, unit):
    contour, holes = area
    return orca.host.ExPolygon(host_polygon(contour, unit), [host_polygon(hole, unit) for hole in holes])


def scaled_box(points):
    xs, ys = [point.x for point in points], [point.y for point in points]
    return min(xs), min(ys), max(xs), max(ys)


def overlap(a, b):
    return a[0] <= b[2] and b[0] <= a[2] and a[1] <= b[3] and b[1] <= a[3]


def without(whole, cuts):
    """What is left of an ExPolygon without the cuts, each an ExPolygon and its box; None if it is touched by none."""
    box = scaled_box(whole.contour.points)
    pieces, cut_any = [whole], False
    for cut, cut_box in cuts:
        if overlap(box, cut_box):
            pieces = [left for piece in pieces for left in piece.diff_ex(cut)]
            cut_any = True
    return pieces if cut_any else None


def planned_cuts(regions, sections, unit, cancelled):
    """The plan, and how much of the sparse infill it leaves out, percent.

    For each collection of surfaces that changes: (collection, [(surface's index, its new shape or None to keep)]).
    """
    plan = []
    area_before = area_after = 0.0
    for layer, region in regions:
        check(cancelled)
        cuts = [host_area(area, unit) for area in sections.get(layer.slice_z, [])]
        cuts = [(cut, scaled_box(cut.contour.points)) for cut in cuts]
        surfaces = region.fill_surfaces.surfaces
        kept, changed = [], False
        for index, surface in enumerate(surfaces):
            pieces = None
            if surface.surface_type == orca.host.SurfaceType.stInternal:
                area_before += surface.area() * layer.height
                pieces = without(surface.expolygon, cuts) if cuts else None
                area_after += (surface.area() if pieces is None else sum(p.area() for p in pieces)) * layer.height
            if pieces is None:
                kept.append((index, None))
            else:
                changed = True
                kept += [(index, piece) for piece in pieces]
        if changed:
            plan.append((region.fill_surfaces, kept))
    return plan, (100 * (1 - area_after / area_before) if area_before else 0.0)


def copy_of(surface):
    shape = surface.expolygon
    copied = orca.host.Surface(surface.surface_type, orca.host.ExPolygon(shape.contour, shape.holes))
    copied.thickness = surface.thickness
    copied.bridge_angle = surface.bridge_angle
    copied.extra_perimeters = surface.extra_perimeters
    return copied


def apply_cuts(plan):
    """All of the plan, or, if Orca refuses some of it, nothing: the exception goes on with everything as it was."""
    done = []
    try:
        for collection, kept in plan:
            surfaces = collection.surfaces
            done.append((collection, [copy_of(surface) for surface in surfaces]))
            # Whole surfaces are copied, with what Orca keeps in them and does not show, and then get their shapes.
            collection.set([surfaces[index] for index, _ in kept])
            for surface, (_, shape) in zip(collection.surfaces, kept):
                if shape is not None:
                    surface.expolygon = shape
    except Exception:
        for collection, before in done:
            collection.set(before)
        raise


class AerateInfill(orca.slicing.SlicingPipelineCapabilityBase):
    def __init__(self):
        super().__init__()
        self._packings = Packings()

    def get_name(self):
        return "Aerate Infill"

    def get_default_config(self):
        return dict(DEFAULTS)

    def execute(self, ctx):
        if ctx.step != orca.slicing.Step.posPrepareInfill or ctx.object is None:
            return orca.ExecutionResult.skipped()
        strict = False
        try:
            options = checked_options(self.get_config())
            strict = options["strict"]
            if not options["enabled"]:
                return orca.ExecutionResult.skipped()
            return orca.ExecutionResult.success(self._note(ctx, self._cut(ctx, options)))
        except Cancelled:
            return orca.ExecutionResult.skipped("cancelled")
        except Exception as error:  # whatever it is, it must not cost the print
            reason = str(error) if isinstance(error, Refused) else "%s: %s" % (type(error).__name__, error)
            message = self._note(ctx, "nothing left out: " + reason)
            if strict:
                return orca.ExecutionResult.failure(orca.PluginResult.FatalError, message)
            return orca.ExecutionResult.skipped(message)

    def _cut(self, ctx, options):
        density = sparse_density(ctx.object, ctx)
        regions = sparse_regions(ctx.object, density) if density else []
        if not regions:
            return "no sparse infill in it"
        unit = orca.slicing.unscale(1)
        region = regions[0][1]

        def setting(name):
            value = region.config_value(name)
            if value is None:
                value = ctx.object.config_value(name)
            return value if value is not None else ctx.config_value(name)

        parts, solid = placed_meshes(ctx.object, unit)
        check(ctx.cancelled)
        packing = self._packings.get(
            options,
            wall_of_perimeters(setting),
            binary_stl(*parts),
            binary_stl(*solid) if solid else None,
            self._folder(),
            ctx.cancelled,
        )
        heights = sorted({layer.slice_z for layer, _ in regions})
        sections = dict(zip(heights, packing.sections(heights, ctx.cancelled)))
        plan, share = planned_cuts(regions, sections, unit, ctx.cancelled)
        check(ctx.cancelled)
        apply_cuts(plan)
        return "%.1f %% of the sparse infill left out, in %d layers" % (share, len(plan))

    def _folder(self):
        try:
            return orca.host.plugin.storage()
        except AttributeError:  # the first versions have no such folder
            return os.path.dirname(os.path.abspath(__file__))

    def _note(self, ctx, message):
        """The message with the object's name before it, which also goes into the plugin's log."""
        name = ctx.object.model_object().name or "object"
        message = " ".join(("%s: %s" % (name, message)).split())
        try:
            path = os.path.join(self._folder(), "aerate.log")
            is_long = os.path.exists(path) and os.path.getsize(path) > LARGEST_LOG
            with open(path, "w" if is_long else "a", encoding="utf-8") as file:
                file.write("%s %s\n" % (time.strftime("%Y-%m-%d %H:%M:%S"), message))
        except Exception:  # a print without a log is better than none
            pass
        return message


@orca.plugin
class AeratePlugin(orca.base):
    def register_capabilities(self):
        orca.register_capability(AerateInfill)

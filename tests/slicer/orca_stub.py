"""What OrcaSlicer's documentation says of the module `orca`, as far as a plugin of the slicing pipeline needs it.

Written from the wiki (developer_reference/plugin_development) and from the bindings that it describes
(src/slic3r/plugin), and as strict as they are: coordinates are whole numbers, references end when their list is
replaced, arrays can be had as rows only, the user is asked about each process and each file outside of the plugin's
folder, and the user interface must not be called. Polygons are cut by scanlines, exactly but for fp64.
"""

import enum
import math
import os
import sys
import types

UNIT = 1e-6  # mm


class AskedTheUser(PermissionError):
    pass


# ---- geometry


class Point:
    def __init__(self, x, y):
        if type(x) is not int or type(y) is not int:
            raise TypeError("coordinates are int64")
        self.x, self.y = x, y


class Polygon:
    def __init__(self):
        self._points = []

    @property
    def points(self):
        return list(self._points)

    def append(self, point):
        if not isinstance(point, Point):
            raise TypeError("no Point")
        self._points.append(point)

    def _pairs(self):
        return [(point.x, point.y) for point in self._points]


def _area(pairs):
    return sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(pairs, pairs[1:] + pairs[:1])) / 2


def _polygon(pairs):
    polygon = Polygon()
    for x, y in pairs:
        polygon.append(Point(x, y))
    return polygon


class ExPolygon:
    def __init__(self, contour, holes=None):
        for polygon in [contour] + list(holes or []):
            if not isinstance(polygon, Polygon):
                raise ValueError("no Polygon")

        def oriented(polygon, sign):
            pairs = polygon._pairs()
            return _polygon(pairs if sign * _area(pairs) >= 0 else pairs[::-1])

        self.contour = oriented(contour, 1)
        self.holes = [oriented(hole, -1) for hole in holes or []]

    def rings(self):
        return [self.contour._pairs()] + [hole._pairs() for hole in self.holes]

    def area(self):
        return sum(_area(ring) for ring in self.rings())

    def box(self):
        xs, ys = zip(*self.contour._pairs())
        return min(xs), min(ys), max(xs), max(ys)

    def contains_mm(self, x, y):
        return sum(_crosses(ring, x / UNIT, y / UNIT) for ring in self.rings()) % 2 == 1

    def diff_ex(self, other):
        if not isinstance(other, ExPolygon):
            raise TypeError("no ExPolygon")
        a, b = self.box(), other.box()
        if a[0] > b[2] or b[0] > a[2] or a[1] > b[3] or b[1] > a[3]:
            return [ExPolygon(self.contour, self.holes)]
        mine, theirs = _edges(self.rings()), _edges(other.rings())
        if not any(_meet(e, f) for e in mine for f in theirs):
            x, y = other.rings()[0][0]
            inside = sum(_crosses(ring, x, y) for ring in self.rings()) % 2 == 1
            holds_mine = any(_crosses(other.rings()[0], *ring[0]) for ring in self.rings())
            if inside and not holds_mine and not other.holes:
                return [ExPolygon(self.contour, self.holes + [other.contour])]
            if not inside and not holds_mine:
                return [ExPolygon(self.contour, self.holes)]
        return _scanline_difference(mine, theirs)


def _edges(rings):
    return [(a, b) for ring in rings for a, b in zip(ring, ring[1:] + ring[:1]) if a != b]


def _crosses(ring, x, y):
    inside = False
    for (x0, y0), (x1, y1) in zip(ring, ring[1:] + ring[:1]):
        if (y0 > y) != (y1 > y) and x < x0 + (y - y0) / (y1 - y0) * (x1 - x0):
            inside = not inside
    return inside


def _meet(e, f):
    if max(e[0][0], e[1][0]) < min(f[0][0], f[1][0]) or max(f[0][0], f[1][0]) < min(e[0][0], e[1][0]):
        return False
    if max(e[0][1], e[1][1]) < min(f[0][1], f[1][1]) or max(f[0][1], f[1][1]) < min(e[0][1], e[1][1]):
        return False

    def side(a, b, c):
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])

    return side(*e, f[0]) * side(*e, f[1]) <= 0 and side(*f, e[0]) * side(*f, e[1]) <= 0


def _x_at(edge, y):
    (x0, y0), (x1, y1) = edge
    return x0 + (y - y0) / (y1 - y0) * (x1 - x0)


def _scanline_difference(mine, theirs):
    """As trapezoids between the heights at which something begins, ends or crosses."""
    every = mine + theirs
    heights = {point[1] for edge in every for point in edge}
    for at, e in enumerate(every):
        for f in every[at + 1 :]:
            if _meet(e, f):
                (x1, y1), (x2, y2) = e
                (x3, y3), (x4, y4) = f
                below = (x1 - x2) * (y3 - y4) - (y1 - y2) * (x3 - x4)
                if below:
                    t = ((x1 - x3) * (y3 - y4) - (y1 - y3) * (x3 - x4)) / below
                    heights.add(y1 + t * (y2 - y1))
    heights = sorted(heights)
    pieces = []
    for low, high in zip(heights, heights[1:]):
        if high - low < 2:
            continue
        middle = (low + high) / 2
        ends = []
        for is_mine, edges in ((True, mine), (False, theirs)):
            for edge in edges:
                if (edge[0][1] > middle) != (edge[1][1] > middle):
                    ends.append((_x_at(edge, middle), is_mine, edge))
        ends.sort(key=lambda end: end[0])
        in_mine = in_theirs = False
        for (_, is_mine, edge), following in zip(ends, ends[1:]):
            if is_mine:
                in_mine = not in_mine
            else:
                in_theirs = not in_theirs
            if in_mine and not in_theirs:
                corners = []
                for e, y in ((edge, low), (following[2], low), (following[2], high), (edge, high)):
                    corner = (round(_x_at(e, y)), round(y))
                    if corner not in corners:
                        corners.append(corner)
                if len(corners) > 2 and _area(corners) > 0:
                    pieces.append(ExPolygon(_polygon(corners)))
    return pieces


# ---- what is sliced


class SurfaceType(enum.Enum):
    stTop = 0
    stBottom = 1
    stInternal = 2
    stInternalSolid = 3
    stInternalBridge = 4
    stInternalVoid = 5


class Surface:
    def __init__(self, surface_type, expolygon):
        if not isinstance(surface_type, SurfaceType) or not isinstance(expolygon, ExPolygon):
            raise TypeError("Surface(surface_type, expolygon)")
        self._is_live = True
        self._values = {
            "surface_type": surface_type,
            "expolygon": ExPolygon(expolygon.contour, expolygon.holes),
            "thickness": -1.0,
            "bridge_angle": -1.0,
            "extra_perimeters": 0,
        }
        self.hidden = 1  # thickness_layers, which the bindings do not show

    def _copy(self):
        copied = Surface(self.surface_type, self.expolygon)
        copied._values.update(thickness=self.thickness, bridge_angle=self.bridge_angle)
        copied._values.update(extra_perimeters=self.extra_perimeters)
        copied.hidden = self.hidden
        return copied

    def area(self):
        return self.expolygon.area()


def _property(name):
    def get(self):
        if not self._is_live:
            raise AssertionError("a reference into a list that was replaced")
        return self._values[name]

    def put(self, value):
        get(self)
        self._values[name] = value

    return property(get, put)


for _name in ("surface_type", "expolygon", "thickness", "bridge_angle", "extra_perimeters"):
    setattr(Surface, _name, _property(_name))


class SurfaceCollection:
    def __init__(self, surfaces):
        self._surfaces = list(surfaces)
        self.refuses = False

    @property
    def surfaces(self):
        return list(self._surfaces)

    def has(self, surface_type):
        return any(surface.surface_type == surface_type for surface in self._surfaces)

    def set(self, surfaces):
        copies = [surface._copy() for surface in surfaces]
        if self.refuses:
            self.refuses = False
            raise RuntimeError("refused")
        for surface in self._surfaces:
            surface._is_live = False
        self._surfaces = copies


class Settings:
    def __init__(self, values):
        self._values = values

    def config_value(self, key):
        return self._values.get(key)


class LayerRegion(Settings):
    def __init__(self, surfaces, values):
        super().__init__(values)
        self.fill_surfaces = SurfaceCollection(surfaces)


class Layer:
    def __init__(self, slice_z, height, islands, regions):
        self.slice_z, self.height, self.print_z = slice_z, height, slice_z + height / 2
        self._islands, self._regions = islands, regions

    def lslices(self):
        return list(self._islands)

    def regions(self):
        return list(self._regions)


class Rows:
    """In the place of a NumPy array: no list, but rows that make one."""

    def __init__(self, values):
        self._values = values

    def tolist(self):
        return [list(row) for row in self._values]


class TriangleMesh:
    def __init__(self, vertices, triangles):
        self._vertices, self._triangles = vertices, triangles

    def vertices(self):
        return Rows(self._vertices)

    def triangles(self):
        return Rows(self._triangles)


class ModelVolume:
    def __init__(self, mesh, matrix, kind="part"):
        self._mesh, self._matrix, self._kind = mesh, matrix, kind

    def mesh(self):
        return TriangleMesh(*self._mesh)

    def matrix(self):
        return Rows(self._matrix)

    def is_model_part(self):
        return self._kind == "part"

    def is_negative_volume(self):
        return self._kind == "negative"


class ModelInstance:
    def __init__(self, matrix):
        self._matrix = matrix

    def matrix(self):
        return Rows(self._matrix)


class ModelObject(Settings):
    def __init__(self, name, volumes, instances, values):
        super().__init__(values)
        self.name = name
        self._volumes, self._instances = volumes, instances

    def volumes(self):
        return list(self._volumes)

    def instance_count(self):
        return len(self._instances)

    def instance(self, index):
        return self._instances[index]


class PrintObject(Settings):
    def __init__(self, model_object, trafo, box, layers, values):
        super().__init__(values)
        self._model_object, self._trafo, self._box, self._layers = model_object, trafo, box, layers

    def model_object(self):
        return self._model_object

    def trafo(self):
        return Rows(self._trafo)

    def bounding_box(self):
        return self._box

    def layers(self):
        return list(self._layers)


# ---- the pipeline


class Step(enum.Enum):
    posSlice = 0
    posPerimeters = 1
    posPrepareInfill = 2
    posInfill = 3
    psSkirtBrim = 4
    psGCodePostProcess = 5


class Context(Settings):
    def __init__(self, step, print_object, values, cancelled=lambda: False):
        super().__init__(values)
        self.step, self.object, self.cancelled = step, print_object, cancelled


class PluginResult(enum.Enum):
    Success = 0
    Skipped = 1
    RecoverableError = 2
    FatalError = 3


class ExecutionResult:
    def __init__(self, status, message):
        if not isinstance(message, str):
            raise TypeError("a message is a str")
        self.status, self.message = status, message

    @staticmethod
    def success(message="", data=""):
        return ExecutionResult(PluginResult.Success, message)

    @staticmethod
    def skipped(message=""):
        return ExecutionResult(PluginResult.Skipped, message)

    @staticmethod
    def failure(status, message, data=""):
        return ExecutionResult(status, message)


class Base:
    pass


class CapabilityBase:
    def __init__(self):
        self.saved = None

    def get_config(self):
        return "{}" if self.saved is None else self.saved


class Host:
    """A loaded plugin, and what Orca asks the user while it runs."""

    running = None

    def __init__(self, storage):
        self.storage = storage
        self.packages, self.capabilities = [], []
        self.processes = []  # the command line of each, as the user is asked about it
        self.allows_processes = True

    def module(self):
        orca = types.ModuleType("orca")
        orca.base, orca.PluginResult, orca.ExecutionResult = Base, PluginResult, ExecutionResult
        orca.plugin = lambda package: self.packages.append(package) or package
        orca.register_capability = self.capabilities.append
        orca.slicing = types.SimpleNamespace(
            Step=Step, SlicingPipelineCapabilityBase=CapabilityBase, unscale=lambda scaled: scaled * UNIT
        )
        orca.host = types.SimpleNamespace(
            Point=Point,
            Polygon=Polygon,
            ExPolygon=ExPolygon,
            Surface=Surface,
            SurfaceType=SurfaceType,
            plugin=types.SimpleNamespace(storage=lambda: self.storage),
        )
        return orca

    def execute(self, capability, context):
        Host.running = self
        try:
            return capability.execute(context)
        finally:
            Host.running = None

    def audit(self, event, arguments):
        if event == "open":
            path = os.path.abspath(os.fsdecode(arguments[0])) if not isinstance(arguments[0], int) else self.storage
            if os.path.commonpath([path, os.path.abspath(self.storage)]) != os.path.abspath(self.storage):
                raise AskedTheUser("open %s" % path)
        elif event == "subprocess.Popen":
            self.processes.append(str(arguments[1]))
            if not self.allows_processes:
                raise AskedTheUser("not allowed")
        elif event.split(".")[0] in ("glob", "shutil", "tempfile", "socket", "http", "urllib") or event in (
            "os.listdir",
            "os.scandir",
            "os.mkdir",
            "os.remove",
            "os.rename",
            "os.rmdir",
            "os.system",
            "os.fork",
        ):
            raise AskedTheUser(event)


def _audit(event, arguments):
    if Host.running is not None:
        Host.running.audit(event, arguments)


sys.addaudithook(_audit)


# ---- slicing of a block-like object for tests: layers whose islands and sparse infill are given by functions


def rectangle(x0, y0, x1, y1):
    return ExPolygon(_polygon([tuple(round(c / UNIT) for c in p) for p in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]))


def polygon_mm(points):
    return ExPolygon(_polygon([(round(x / UNIT), round(y / UNIT)) for x, y in points]))


def regular(x, y, radius, corners=96):
    return polygon_mm(
        [
            (x + radius * math.cos(2 * math.pi * k / corners), y + radius * math.sin(2 * math.pi * k / corners))
            for k in range(corners)
        ]
    )

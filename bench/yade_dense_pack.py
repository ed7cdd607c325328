"""yade_dense_pack.py MODEL.stl RADIUS FUZZ OUT: YADE's random dense packing in a closed mesh, for bench_peers.

Run by yade itself: yade -n -x yade_dense_pack.py ... OUT gets the seconds of the packing, then a line
"x y z radius" for each sphere. Radii are RADIUS (1 - FUZZ) to RADIUS (1 + FUZZ).
"""
import struct
import sys
import time

import gts
from yade import pack


def triangles_of(model):
    """Of a binary STL; corners that are the same are the same to the bit, which YADE's own reader does not keep."""
    with open(model, "rb") as file:
        (count,) = struct.unpack_from("<I", file.read(84), 80)
        for record in struct.iter_unpack("<12x9f2x", file.read(50 * count)):
            yield record[0:3], record[3:6], record[6:9]


def surface_of(model):
    surface = gts.Surface()
    vertices, edges = {}, {}

    def vertex(point):
        if point not in vertices:
            vertices[point] = gts.Vertex(*point)
        return vertices[point]

    def edge(a, b):
        key = frozenset((a, b))
        if key not in edges:
            edges[key] = gts.Edge(vertex(a), vertex(b))
        return edges[key]

    for a, b, c in triangles_of(model):
        surface.add(gts.Face(edge(a, b), edge(b, c), edge(c, a)))
    return surface


model, radius, fuzz, out = sys.argv[1], float(sys.argv[2]), float(sys.argv[3]), sys.argv[4]
inside = pack.inGtsSurface(surface_of(model))
start = time.perf_counter()
spheres = pack.randomDensePack(inside, radius=radius, rRelFuzz=fuzz, spheresInCell=1000, memoizeDb=None, seed=1, returnSpherePack=True)
seconds = time.perf_counter() - start
with open(out, "w") as file:
    file.write(f"{seconds}\n")
    for centre, size in spheres:
        file.write(f"{centre[0]!r} {centre[1]!r} {centre[2]!r} {size!r}\n")

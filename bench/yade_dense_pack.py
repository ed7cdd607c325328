"""yade_dense_pack.py MODEL.stl RADIUS FUZZ OUT: YADE's random dense packing in a closed mesh, for bench_peers.

Run by yade itself: yade -n -x yade_dense_pack.py ... OUT gets the seconds of the packing, then a line
"x y z radius" for each sphere. Radii are RADIUS (1 - FUZZ) to RADIUS (1 + FUZZ).
"""
import sys
import time

import gts
from yade import pack, ymport


def surface_of(model):
    surface = gts.Surface()
    vertices, edges = {}, {}

    def vertex(point):
        return vertices.setdefault(point, gts.Vertex(*point))

    def edge(a, b):
        return edges.setdefault(frozenset((a, b)), gts.Edge(vertex(a), vertex(b)))

    for facet in ymport.stl(model):
        a, b, c = (tuple(facet.state.pos + corner) for corner in facet.shape.vertices)
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

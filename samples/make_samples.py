#!/usr/bin/env python3
"""Makes the samples that are not scans: bracket.stl and pawn.obj. Run in this folder; needs Python 3 only."""
import math
import struct


def write_stl(path, triangles):
    with open(path, "wb") as file:
        file.write(b"aerate sample".ljust(80, b" "))
        file.write(struct.pack("<I", len(triangles)))
        for a, b, c in triangles:
            u = [b[i] - a[i] for i in range(3)]
            v = [c[i] - a[i] for i in range(3)]
            n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
            length = math.sqrt(sum(x * x for x in n))
            file.write(struct.pack("<12fH", *(x / length for x in n), *a, *b, *c, 0))


def extrude(outline, y0, y1):
    """A prism over an outline in x-z that is star-shaped from its first point (a corner) as a fan."""
    front = [(x, y0, z) for x, z in outline]
    back = [(x, y1, z) for x, z in outline]
    triangles = []
    n = len(outline)
    for i in range(1, n - 1):
        triangles.append((front[0], front[i], front[i + 1]))
        triangles.append((back[0], back[i + 1], back[i]))
    for i in range(n):
        j = (i + 1) % n
        triangles.append((front[i], back[i], back[j]))
        triangles.append((front[i], back[j], front[j]))
    return triangles


def bracket():
    """An L-shaped shelf bracket, 80 x 40 x 70 mm, arms 22 and 24 mm thick, with a rounded inner corner."""
    radius, steps = 14.0, 10
    # Counter-clockwise seen from -y, beginning at the outer corner, from which all is visible.
    outline = [(0.0, 0.0), (80.0, 0.0), (80.0, 22.0)]
    cx, cz = 24.0 + radius, 22.0 + radius
    for k in range(steps + 1):
        angle = math.radians(270 - 90 * k / steps)
        outline.append((cx + radius * math.cos(angle), cz + radius * math.sin(angle)))
    outline += [(24.0, 70.0), (0.0, 70.0)]
    return extrude(outline, 0.0, 40.0)


def pawn():
    """A chess pawn, 60 mm tall, 32 mm wide, as a surface of revolution about z: vertices and quads."""
    profile = [(16.0, 0.0), (16.0, 5.0), (14.5, 7.5), (11.5, 9.5), (12.0, 12.0), (9.5, 16.0)]
    profile += [(6.8 + 2.7 * (1 - k / 8) ** 2, 16.0 + 18.0 * k / 8) for k in range(1, 9)]
    profile += [(10.5, 35.5), (10.5, 37.5), (7.5, 39.0)]
    head, centre = 10.7, 49.3
    start = math.asin((39.8 - centre) / head)
    for k in range(16):
        angle = start + (math.pi / 2 - start) * k / 16
        profile.append((head * math.cos(angle), centre + head * math.sin(angle)))
    around = 72
    vertices = [(r * math.cos(2 * math.pi * k / around), r * math.sin(2 * math.pi * k / around), z)
                for r, z in profile for k in range(around)]
    bottom, top = len(vertices), len(vertices) + 1
    vertices += [(0.0, 0.0, 0.0), (0.0, 0.0, centre + head)]
    faces = []
    for ring in range(len(profile) - 1):
        for k in range(around):
            a, b = ring * around + k, ring * around + (k + 1) % around
            faces.append((a, b, b + around, a + around))
    last = (len(profile) - 1) * around
    for k in range(around):
        faces.append((bottom, (k + 1) % around, k))
        faces.append((top, last + k, last + (k + 1) % around))
    return vertices, faces


def write_obj(path, vertices, faces):
    with open(path, "w", encoding="ascii") as file:
        file.write("# aerate sample: a chess pawn, millimetres\no pawn\n")
        for v in vertices:
            file.write("v %.6g %.6g %.6g\n" % v)
        for f in faces:
            file.write("f " + " ".join(str(i + 1) for i in f) + "\n")


if __name__ == "__main__":
    write_stl("bracket.stl", bracket())
    write_obj("pawn.obj", *pawn())

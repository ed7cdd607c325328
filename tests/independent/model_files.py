"""Reads and writes models by NumPy alone, sharing nothing with the program: what its results are held against."""
import re
import struct
import xml.etree.ElementTree as ElementTree
import zipfile
from pathlib import Path

import numpy as np


class NotRead(Exception):
    """This reader makes nothing of the file, which need not be the file's fault."""


class Model:
    """corners: (n, 3, 3) in mm, triangle by triangle, polygons cut into fans; whole: which of them stand in the
    file as triangles (a polygon may be cut otherwise)."""

    def __init__(self, corners, whole=None):
        with np.errstate(over="ignore"):
            self.corners = np.asarray(corners, np.float64).reshape(-1, 3, 3).astype(np.float32).astype(np.float64)
        self.whole = np.ones(len(self.corners), bool) if whole is None else np.asarray(whole, bool)
        if len(self.corners) == 0 or not np.isfinite(self.corners).all():
            raise NotRead("no triangles, or places that are not finite")


def from_faces(points, faces):
    """Of faces as lists of indices into points."""
    points = np.asarray(points, np.float64).reshape(-1, 3)
    fans = [(face[0], face[i], face[i + 1]) for face in faces for i in range(1, len(face) - 1)]
    whole = [len(face) == 3 for face in faces for _ in range(1, len(face) - 1)]
    indices = np.asarray(fans, np.int64).reshape(-1, 3)
    if len(indices) and (indices.min() < 0 or indices.max() >= len(points)):
        raise NotRead("an index out of range")
    return Model(points[indices], whole)


FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", 9), ("extra", "<u2")])


def read_stl(data):
    count = struct.unpack_from("<I", data, 80)[0] if len(data) >= 84 else 0
    if len(data) == 84 + 50 * count and count:
        return Model(np.frombuffer(data, FACET, count, 84)["corners"])
    if not data.lstrip()[:5].lower() == b"solid":
        raise NotRead("neither a binary nor a text STL")
    numbers = re.findall(rb"^\s*vertex\s+(\S+)\s+(\S+)\s+(\S+)\s*$", data, re.M | re.I)
    if len(numbers) % 3 or len(re.findall(rb"^\s*facet\b", data, re.M | re.I)) * 3 != len(numbers):
        raise NotRead("text STL of other lines")
    return Model(np.array(numbers).astype(np.float64))


def read_obj(data):
    text = re.sub(r"\\\r?\n", " ", data.decode("utf-8-sig", "replace"))
    points, faces = [], []
    for line in text.splitlines():
        words = line.split("#")[0].split()
        if words[:1] == ["v"]:
            points.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            indices = [int(word.split("/")[0]) for word in words[1:]]
            faces.append([i - 1 if i > 0 else len(points) + i for i in indices])
    return from_faces(points, faces)


def read_off(data):
    lines = [line.split("#")[0].split() for line in data.decode("ascii", "replace").splitlines()]
    lines = [line for line in lines if line]
    if not lines or not re.fullmatch(r"(ST|C|N)*OFF", lines[0][0]):
        raise NotRead("not an OFF of three dimensions in text")
    lines[0] = lines[0][1:]
    lines = [line for line in lines if line]
    vertex_count, face_count = int(lines[0][0]), int(lines[0][1])
    vertices, faces = lines[1:1 + vertex_count], lines[1 + vertex_count:1 + vertex_count + face_count]
    if len(faces) != face_count:
        raise NotRead("fewer lines than faces")
    return from_faces([[float(x) for x in line[:3]] for line in vertices],
                      [[int(i) for i in line[1:1 + int(line[0])]] for line in faces])


PLY_TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
             "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
             "double": "f8", "float64": "f8"}


def read_ply(data):
    head = re.match(rb"ply\r?\n.*?\nend_header\r?\n", data, re.S)
    if not head:
        raise NotRead("not a PLY")
    mark, elements = None, []
    for line in head.group().decode("ascii", "replace").splitlines():
        words = line.split()
        if words[:1] == ["format"]:
            mark = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}[words[1]]
        elif words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"]:
            elements[-1][2].append(words[1:])
    body, at = data[head.end():], 0
    words = body.split() if mark == "" else None

    def take(kind):
        nonlocal at
        if words is not None:
            at += 1
            return float(words[at - 1])
        value = struct.unpack_from(mark + np.dtype(kind).char, body, at)[0]
        at += np.dtype(kind).itemsize
        return value

    points, faces = [], []
    for name, count, properties in elements:
        for _ in range(count):
            row = {}
            for kind, *rest in properties:
                if kind == "list":
                    row[rest[2]] = [take(PLY_TYPES[rest[1]]) for _ in range(int(take(PLY_TYPES[rest[0]])))]
                else:
                    row[rest[0]] = take(PLY_TYPES[kind])
            if name == "vertex":
                points.append((row["x"], row["y"], row["z"]))
            elif name == "face":
                faces.append([int(i) for i in row.get("vertex_indices", row.get("vertex_index"))])
            elif name == "tristrips":
                raise NotRead("strips")
    return from_faces(points, faces)


MM_PER = {"micron": 0.001, "millimeter": 1, "centimeter": 10, "inch": 25.4, "foot": 304.8, "meter": 1000}


def read_3mf(path):
    with zipfile.ZipFile(path) as package:
        relations = ElementTree.fromstring(package.read("_rels/.rels"))
        target = next(r.get("Target") for r in relations if r.get("Type", "").endswith("/3dmodel"))
        root = ElementTree.fromstring(package.read(target.lstrip("/")))
    if root.get("requiredextensions") or any("path" in key.lower() for item in root.iter() for key in item.keys()
                                             if item.tag.endswith(("}component", "}item"))):
        raise NotRead("extensions")
    space = root.tag[:root.tag.index("}") + 1]
    objects = {thing.get("id"): thing for thing in root.iter(space + "object")}

    def matrix_of(item):
        rows = np.array([float(x) for x in (item.get("transform") or "1 0 0 0 1 0 0 0 1 0 0 0").split()]).reshape(4, 3)
        return rows[:3], rows[3]

    def corners_of(number, depth=0):
        thing = objects[number]
        if thing.get("type", "model") != "model" or depth > 50:
            return np.zeros((0, 3, 3))
        mesh = thing.find(space + "mesh")
        if mesh is not None:
            points = np.array([[float(v.get(axis)) for axis in "xyz"] for v in mesh.iter(space + "vertex")])
            faces = [[int(t.get(corner)) for corner in ("v1", "v2", "v3")] for t in mesh.iter(space + "triangle")]
            return points[np.array(faces, np.int64).reshape(-1, 3)] if faces else np.zeros((0, 3, 3))
        parts = [np.zeros((0, 3, 3))]
        for component in thing.iter(space + "component"):
            linear, shift = matrix_of(component)
            parts.append(corners_of(component.get("objectid"), depth + 1) @ linear + shift)
        return np.concatenate(parts)

    parts = [np.zeros((0, 3, 3))]
    for item in root.find(space + "build"):
        if item.get("printable", "1") in ("0", "false"):
            continue
        linear, shift = matrix_of(item)
        parts.append(corners_of(item.get("objectid")) @ linear + shift)
    return Model(np.concatenate(parts) * MM_PER[root.get("unit", "millimeter")])


READERS = {".stl": read_stl, ".obj": read_obj, ".off": read_off, ".ply": read_ply}


def read_model(path):
    """Raises NotRead for what these few lines do not understand."""
    path = Path(path)
    ending = path.suffix.lower()
    try:
        if ending == ".3mf":
            return read_3mf(path)
        if ending in READERS:
            return READERS[ending](path.read_bytes())
    except (ValueError, KeyError, IndexError, TypeError, StopIteration, struct.error, zipfile.BadZipFile,
            ElementTree.ParseError, RuntimeError, NotImplementedError) as error:
        raise NotRead(str(error)) from error
    raise NotRead(f"{ending} is not read here")


def indexed(corners):
    """Points and, for each triangle, three indices into them; corners at one place are one."""
    flat = corners.reshape(-1, 3) + 0.0  # -0 is 0
    points, numbers = np.unique(flat, axis=0, return_inverse=True)
    return points, numbers.reshape(-1, 3)


def write_model(path, corners):
    path = Path(path)
    points, faces = indexed(corners.astype(np.float32))
    rows = lambda pattern, table: "".join(pattern % tuple(row) for row in table)
    if path.suffix == ".stl":
        facets = np.zeros(len(corners), FACET)
        facets["corners"] = corners.reshape(-1, 9)
        path.write_bytes(bytes(80) + struct.pack("<I", len(corners)) + facets.tobytes())
    elif path.suffix == ".obj":
        path.write_text(rows("v %.9g %.9g %.9g\n", points) + rows("f %d %d %d\n", faces + 1))
    elif path.suffix == ".off":
        path.write_text("OFF\n%d %d 0\n" % (len(points), len(faces)) + rows("%.9g %.9g %.9g\n", points)
                        + rows("3 %d %d %d\n", faces))
    elif path.suffix == ".ply":
        header = ("ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
                  "element face %d\nproperty list uchar int vertex_indices\nend_header\n" % (len(points), len(faces)))
        path.write_text(header + rows("%.9g %.9g %.9g\n", points) + rows("3 %d %d %d\n", faces))
    else:
        raise ValueError(path.suffix)

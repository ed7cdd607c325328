"""Holds a result of `aerate hollow` against the model and against what its report says, by means of its own: brute
force and NumPy. Nothing here is from the program, nor from its own check of what it wrote."""
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from model_files import indexed

ROUNDING = 4e-7  # of the largest coordinate: what fp32, and decimal text in between, may move a coordinate


def volume_of(corners, origin):
    a, b, c = (corners[:, i] - origin for i in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)) / 6


def edges_of(faces):
    """Directed edges, one number each, and the same the other way."""
    start, end = faces.reshape(-1), faces[:, [1, 2, 0]].reshape(-1)
    many = int(faces.max()) + 1
    return start * many + end, end * many + start


def open_edge_count(faces):
    """Undirected edges of one triangle."""
    there, back = edges_of(faces)
    return int((np.unique(np.minimum(there, back), return_counts=True)[1] == 1).sum())


def is_closed(faces):
    """Along each edge triangles run equally often both ways."""
    there, back = edges_of(faces)
    return np.array_equal(np.sort(there), np.sort(back))


def is_manifold(faces):
    there, _ = edges_of(faces)
    return is_closed(faces) and len(np.unique(there)) == len(there)


def components_of(faces):
    """For each triangle the number of its component (by shared vertices), and how many there are."""
    start, end = faces.reshape(-1), faces[:, [1, 2, 0]].reshape(-1)
    used, numbers = np.unique(np.concatenate([start, end]), return_inverse=True)
    half = len(start)
    graph = coo_matrix((np.ones(half, np.int8), (numbers[:half], numbers[half:])), (len(used), len(used)))
    count, labels = connected_components(graph, directed=False)
    return labels[numbers[:half]].reshape(-1, 3)[:, 0], count


def winding_numbers(corners, places):
    """By the solid angles of all triangles (van Oosterom and Strackee, 1983)."""
    result = []
    for place in places:
        a, b, c = (corners[:, i] - place for i in range(3))
        la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
        dot = lambda u, v: np.einsum("ij,ij->i", u, v)
        determinant = dot(a, np.cross(b, c))
        below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
        result.append(np.arctan2(determinant, below).sum() / (2 * np.pi))
    return np.array(result)


def distances(places, corners):
    """Of each place to the nearest triangle: over its inside, then over its edges."""
    nearest = np.full(len(places), np.inf)
    a, b, c = (corners[:, i] for i in range(3))
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1)
    flat = length > 0
    for i, place in enumerate(places):
        best = np.inf
        inside = flat.copy()
        for p, q in ((a, b), (b, c), (c, a)):
            along = q - p
            squared = np.maximum(np.einsum("ij,ij->i", along, along), 1e-300)
            t = np.clip(np.einsum("ij,ij->i", place - p, along) / squared, 0, 1)
            best = min(best, np.linalg.norm(p + t[:, None] * along - place, axis=1).min())
            inside &= np.einsum("ij,ij->i", np.cross(along, place - p), normal) >= 0
        if inside.any():
            height = np.einsum("ij,ij->i", place - a[inside], normal[inside]) / length[inside]
            best = min(best, np.abs(height).min())
        nearest[i] = best
    return nearest


def rows_as_counts(rows):
    kept, counts = np.unique(np.sort(rows, axis=1), axis=0, return_counts=True)
    return {tuple(row): count for row, count in zip(kept.tolist(), counts.tolist())}


class ResultCheck:
    """faults: in words, one for each thing that does not hold."""

    def __init__(self, model, result, report, seed=0):
        self.model, self.report = model, report
        self.corners = result.corners
        self.points, self.faces = indexed(self.corners)
        self.random = np.random.default_rng(seed)
        self.faults = []
        largest = np.abs(self.corners).max()
        self.rounding = ROUNDING * largest
        self.outer_count = report["output"]["outer_triangles"]
        self.kept = report["surface"]["mode"] == "kept"
        self.drained = report["drainage"] is not None

    def require(self, holds, fault):
        if not holds:
            self.faults.append(fault)

    def near(self, a, b, what, slack):
        self.require(abs(a - b) <= slack, f"{what}: {a:.9g} and not {b:.9g}")

    def run(self):
        self.surface()
        self.volumes()
        if self.kept and self.model is not None:
            self.model_is_there()
        if not self.kept and self.model is not None:
            self.remeshed()
        self.cavities() if self.drained else self.voids()
        return self.faults

    def surface(self):
        output = self.report["output"]
        self.require(len(self.corners) == output["triangles"], "triangles of the file and of the report differ")
        self.require(self.outer_count + output["void_triangles"] == output["triangles"],
                     "triangles outside and of voids do not add up")
        twice = (self.faces == self.faces[:, [1, 2, 0]]).any(axis=1)
        self.require(not twice.any(), f"{twice.sum()} triangles with two equal corners")
        self.require(is_closed(self.faces[~twice]), "the surface is not closed and oriented")
        if self.report["input"]["non_manifold_edges"] == 0 or not self.kept:
            self.require(is_manifold(self.faces[~twice]), "edges of more than two triangles")

    def volumes(self):
        volume = self.report["volume"]
        if volume["estimated"]:
            return
        # About the place that the volumes of tetrahedra are small: round-off stays small too.
        each = volume_of(self.corners, self.points.mean(axis=0))
        slack = 1e-6 * np.abs(each).sum() + 1e-9
        self.near(each.sum(), volume["after_mm3"], "volume of the result", slack)
        self.near(volume["before_mm3"] - volume["removed_mm3"], volume["after_mm3"], "volumes add up", slack)
        if not self.drained:
            self.near(-each[self.outer_count:].sum(), volume["removed_mm3"], "volume of the voids", slack)
            if self.model is not None and self.kept and self.model.whole.all():
                before = volume_of(self.model.corners, self.points.mean(axis=0)).sum()
                turned = self.report["input"]["signed_volume_mm3"] < 0 or self.report["notices"]
                self.require(turned or abs(before - volume["before_mm3"]) <= slack,
                             f"volume of the model: {before:.9g} and not {volume['before_mm3']:.9g}")

    def model_is_there(self):
        """Every triangle that the model's file has (whichever way it is turned), but for those that holes cut."""
        points, faces = indexed(self.model.corners[self.model.whole])
        slack = self.rounding + self.joined_within()
        away, numbers = cKDTree(self.points).query(points, distance_upper_bound=slack)
        numbers = np.where(np.isfinite(away), numbers, -1 - np.arange(len(points)))
        faces = numbers[faces]
        faces = faces[(faces != faces[:, [1, 2, 0]]).all(axis=1)]
        there = rows_as_counts(self.faces[:self.outer_count])
        once = self.noted("left out")  # of triangles that lie in one place some may be missing, if that is said
        missing = sum(max((1 if once else count) - there.get(row, 0), 0) for row, count in rows_as_counts(faces).items())
        allowed = self.report["drainage"]["cut_triangles"] if self.drained else 0
        self.require(missing <= allowed, f"{missing} of {len(faces)} triangles of the model are not in the result")

    def noted(self, words):
        return any(words in notice for notice in self.report["notices"])

    def joined_within(self):
        """Vertices nearer to each other than this may have been joined, where the report says so."""
        if not self.noted("vertices are moved"):
            return 0.0
        return min(1e-5 * np.linalg.norm(np.ptp(self.points, axis=0)), 0.01)

    def remeshed(self):
        """New vertices are as near to the model as the report says, and what is deep inside stays inside."""
        surface = self.report["surface"]
        outer = self.corners[:self.outer_count]
        count = max(4, min(64, 4_000_000 // max(len(self.model.corners), 1)))
        some = self.random.choice(outer.reshape(-1, 3), count)
        off = distances(some, self.model.corners).max()
        if not self.noted("closed"):
            self.require(off <= surface["outer_deviation_mm"] + self.rounding + 1e-6,
                         f"the new surface is {off:.6g} mm off, said was {surface['outer_deviation_mm']:.6g}")
        low, high = self.points.min(axis=0), self.points.max(axis=0)
        places = self.random.uniform(low, high, (max(8, min(64, 8_000_000 // (len(outer) + len(self.model.corners)))), 3))
        inside = winding_numbers(self.model.corners, places) > 0.5
        deep = distances(places, self.model.corners) > 2 * surface["voxel_mm"]
        lost = inside & deep & (winding_numbers(outer, places) < 0.5)
        self.require(not lost.any(), f"{lost.sum()} of {(inside & deep).sum()} places deep inside are outside of the new surface")

    def voids(self):
        report, limits = self.report, self.report["limits"]
        faces = self.faces[self.outer_count:]
        if len(faces) == 0:
            self.faults.append("no triangles of voids")
            return
        self.require(is_manifold(faces), "voids are not closed shells")
        labels, count = components_of(faces)
        self.near(count, report["voids"]["count"], "voids", 0)
        shared = np.intersect1d(faces, self.faces[:self.outer_count])
        self.require(len(shared) == 0, f"voids touch the outer surface in {len(shared)} vertices")
        corners = self.corners[self.outer_count:]
        origin = self.points.mean(axis=0)
        volumes = -np.bincount(labels, volume_of(corners, origin), count)
        self.require((volumes > 0).all(), f"{(volumes <= 0).sum()} voids are not turned inward")
        radii = np.cbrt(np.maximum(volumes, 0) * 3 / (4 * np.pi))  # of the balls of their volumes
        roofs = report["ceilings"]["roofs"] if report["ceilings"] else 0
        least, most = limits["min_radius_mm"] - report["voids"]["tolerance_used_mm"], limits["max_radius_mm"]
        self.require(radii.min() >= least * (0.9 if roofs else 1) - 1e-6, f"a void of radius {radii.min():.6g} mm")
        is_ball = report["voids"]["shape"] == "spheres"  # cells are as large as their share of the model
        self.require(not is_ball or radii.max() <= most * (1.3 if roofs else 1) + 1e-6,
                     f"a void of radius {radii.max():.6g} mm")
        self.walls_and_gaps(corners, labels, count)
        if is_ball:
            centres = np.stack([np.bincount(labels, corners.mean(axis=1)[:, axis], count) for axis in range(3)], 1)
            centres /= np.bincount(labels, minlength=count)[:, None]
        else:
            centres = self.beside_largest_triangles(corners, labels, count)
        some = self.random.permutation(count)[:max(2, min(24, 3_000_000 // len(self.corners)))]
        inside = winding_numbers(self.corners, centres[some])
        if report["input"]["overlapping_shells"] == 0 or not self.kept:
            self.require(np.abs(inside).max() < 1e-3, f"the middle of a void has winding number {inside[np.abs(inside).argmax()]:.3g}")

    def beside_largest_triangles(self, corners, labels, count):
        """A place in each void: it may have any shape."""
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        areas = np.linalg.norm(normals, axis=1)
        order = np.lexsort((areas, labels))
        largest = order[np.searchsorted(labels[order], np.arange(count), side="right") - 1]
        return corners[largest].mean(axis=1) + 0.01 * normals[largest] / areas[largest][:, None]

    def walls_and_gaps(self, corners, labels, count):
        limits = self.report["limits"]
        outer = self.corners[:self.outer_count]
        flat = corners.reshape(-1, 3)
        # The vertices of voids that are nearest to vertices outside, and some others.
        near = np.argsort(cKDTree(outer.reshape(-1, 3)).query(flat)[0])
        some = max(4, min(48, 4_000_000 // len(outer)))
        places = np.concatenate([flat[near[:some // 2]], self.random.choice(flat, some // 2)])
        wall = distances(places, outer).min()
        self.require(wall >= limits["wall_mm"] - self.rounding - 1e-6, f"a wall of {wall:.6g} mm")
        of_corner = np.repeat(labels, 3)
        for label in self.random.permutation(count)[:12] if count > 1 else []:
            gap = cKDTree(flat[of_corner != label]).query(flat[of_corner == label])[0].min()
            self.require(gap >= limits["gap_mm"] - self.rounding - 1e-6, f"a gap of {gap:.6g} mm")

    def cavities(self):
        labels, count = components_of(self.faces)
        volumes = np.bincount(labels, volume_of(self.corners, self.points.mean(axis=0)), count)
        drainage = self.report["drainage"]
        self.near(drainage["sealed_cavities"], 0, "sealed cavities of voids", 0)
        if self.kept:
            self.near((volumes < 0).sum(), drainage["cavities_of_model"], "sealed cavities", 0)


def inspection_faults(model, report):
    """What `aerate inspect` counts, counted again."""
    faults, figures = [], report["input"]
    points, faces = indexed(model.corners)
    def same(ours, name):
        if ours != figures[name]:
            faults.append(f"{name}: {figures[name]} in the report, {ours} counted")
    same(len(model.corners), "triangles")
    if not model.whole.all():
        return faults
    faces = faces[(faces != faces[:, [1, 2, 0]]).all(axis=1)]
    if len(faces) and is_closed(faces):  # else the volume depends on where it is looked at from
        volume = volume_of(model.corners, points.mean(axis=0))
        if abs(volume.sum() - figures["signed_volume_mm3"]) > 1e-5 * np.abs(volume).sum() + 1e-9:
            faults.append(f"signed volume: {figures['signed_volume_mm3']:.9g} in the report, {volume.sum():.9g} counted")
    if len(points) == figures["vertices"]:  # else coordinates were rounded otherwise, and others are equal
        same(open_edge_count(faces) if len(faces) else 0, "open_edges")
    return faults

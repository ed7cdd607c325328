"""What share of each voxel is material, of a mesh or of a shape that a formula gives; inside by winding numbers."""
import numpy as np

PAIRS = 4_000_000  # of triangles and columns at a time


def crossings(corners, xs, ys):
    """Where the vertical lines at all (x, y) meet triangles: column (y * len(xs) + x), height, and +1 where the line
    leaves the material, -1 where it enters."""
    low, high = corners[:, :, :2].min(axis=1), corners[:, :, :2].max(axis=1)
    first_x, last_x = np.searchsorted(xs, low[:, 0]), np.searchsorted(xs, high[:, 0])
    first_y, last_y = np.searchsorted(ys, low[:, 1]), np.searchsorted(ys, high[:, 1])
    wide, counts = last_x - first_x, (last_x - first_x) * (last_y - first_y)
    found = []
    ends = np.cumsum(counts)
    begin = 0
    while begin < len(corners):
        done = ends[begin - 1] if begin else 0
        end = max(begin + 1, int(np.searchsorted(ends, done + PAIRS)))
        which = np.repeat(np.arange(begin, end), counts[begin:end])
        if len(which):
            rank = np.arange(len(which)) - np.repeat(ends[begin:end] - counts[begin:end] - done, counts[begin:end])
            column_x, column_y = first_x[which] + rank % wide[which], first_y[which] + rank // wide[which]
            a, b, c = (corners[which, i] for i in range(3))
            x, y = xs[column_x], ys[column_y]
            side = lambda p, q: (q[:, 0] - p[:, 0]) * (y - p[:, 1]) - (q[:, 1] - p[:, 1]) * (x - p[:, 0])
            to_a, to_b, to_c = side(b, c), side(c, a), side(a, b)
            area = to_a + to_b + to_c
            hit = ((to_a > 0) & (to_b > 0) & (to_c > 0)) | ((to_a < 0) & (to_b < 0) & (to_c < 0))
            with np.errstate(invalid="ignore", divide="ignore"):
                height = (to_a * a[:, 2] + to_b * b[:, 2] + to_c * c[:, 2]) / area
            found.append((column_y[hit] * len(xs) + column_x[hit], height[hit], np.sign(area[hit]).astype(np.int8)))
        begin = end
    return tuple(np.concatenate(part) for part in zip(*found))


def columns_at(lower, step, count, each, beside):
    """`each` columns in each of `count` voxels, a hair beside where edges of models use to lie."""
    return lower + step * ((np.arange(count * each) + 0.5) / each + beside)


def mesh_fractions(corners, lower, step, shape, each=3):
    """Share of material in each voxel, [x, y, z], from lines along z, each * each a voxel: exact in z."""
    nx, ny, nz = shape
    # Not the same for both, since edges lie along diagonals too.
    xs, ys = columns_at(lower[0], step, nx, each, 1.7e-5), columns_at(lower[1], step, ny, each, 2.9e-5)
    column, height, sign = crossings(np.asarray(corners, np.float64), xs, ys)
    if np.bincount(column, sign, len(xs) * len(ys)).any():
        raise ValueError("the mesh is not closed")
    voxel_x, voxel_y = column % len(xs) // each, column // len(xs) // each
    height = np.clip((height - lower[2]) / step, 0, nz)
    cell = np.minimum(height.astype(np.int64), nz - 1)
    inside = height - cell
    at = (voxel_x * ny + voxel_y) * nz + cell
    here, above = (np.bincount(at, weights, nx * ny * nz).reshape(shape) for weights in (sign * inside, sign))
    # A voxel is filled up to each crossing in it, and wholly by crossings further up.
    further = above[:, :, ::-1].cumsum(axis=2)[:, :, ::-1] - above
    share = (here + further) / each ** 2
    return np.clip(share, 0, 1)


def formula_fractions(inside, lower, step, shape, each=4):
    """Of a function inside(x, y, z), asked at each ** 3 points of each voxel."""
    axes = [lower[i] + step * (np.arange(shape[i] * each) + 0.5) / each for i in range(3)]
    share = np.zeros(shape)
    for x in range(shape[0]):  # slice by slice, for memory
        grid = np.meshgrid(axes[0][x * each:(x + 1) * each], axes[1], axes[2], indexing="ij")
        hit = inside(*grid).reshape(each, shape[1], each, shape[2], each)
        share[x] = hit.mean(axis=(0, 2, 4))
    return share

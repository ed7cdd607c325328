"""Linear elasticity on voxels: trilinear cubes of eight nodes, conjugate gradients preconditioned by multigrid."""
import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, cg, splu

CORNERS = np.array([[i & 1, i >> 1 & 1, i >> 2 & 1] for i in range(8)])


def material_matrix(poisson):
    """Stress from strain (xx, yy, zz, xy, yz, zx) for a Young's modulus of 1."""
    matrix = np.zeros((6, 6))
    matrix[:3, :3] = poisson
    matrix[range(3), range(3)] = 1 - poisson
    matrix[range(3, 6), range(3, 6)] = (1 - 2 * poisson) / 2
    return matrix / ((1 + poisson) * (1 - 2 * poisson))


def element_matrix(poisson):
    """24 x 24 stiffness of a cube of edge 1 and Young's modulus 1, by 2 x 2 x 2 points of Gauss."""
    material = material_matrix(poisson)
    result = np.zeros((24, 24))
    for point in 0.5 + (CORNERS - 0.5) / np.sqrt(3):
        weights = np.where(CORNERS == 1, point, 1 - point)
        slopes = np.where(CORNERS == 1, 1.0, -1.0)
        gradient = np.stack([slopes[:, i] * weights[:, (i + 1) % 3] * weights[:, (i + 2) % 3] for i in range(3)], axis=1)
        strain = np.zeros((6, 24))
        for i in range(3):
            strain[i, i::3] = gradient[:, i]
        for row, (i, j) in enumerate([(0, 1), (1, 2), (2, 0)], start=3):
            strain[row, i::3] = gradient[:, j]
            strain[row, j::3] = gradient[:, i]
        result += strain.T @ material @ strain / 8
    return result


def node_numbers(shape):
    """Of each element its eight nodes; nodes are numbered with z running fastest, as elements are."""
    x, y, z = np.meshgrid(*(np.arange(n) for n in shape), indexing="ij")
    base = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    strides = np.array([(shape[1] + 1) * (shape[2] + 1), shape[2] + 1, 1])
    return (base[:, None, :] + CORNERS[None]) @ strides


def dof_numbers(nodes):
    return (3 * nodes[:, :, None] + np.arange(3)).reshape(len(nodes), 24).astype(np.int32)


def halves():
    """For each of eight children of an element: how its 24 displacements follow from those of the element."""
    maps = []
    for child in CORNERS:
        at = (child + CORNERS) / 2
        weight = np.prod(np.where(CORNERS[None] == 1, at[:, None], 1 - at[:, None]), axis=2)
        maps.append(np.kron(weight, np.eye(3)))
    return maps


def line_interpolation(coarse):
    fine = np.arange(2 * coarse + 1)
    rows = np.concatenate([fine, fine[1::2]])
    columns = np.concatenate([fine // 2, fine[1::2] // 2 + 1])
    values = np.concatenate([np.where(fine % 2, 0.5, 1.0), np.full(coarse, 0.5)])
    return sparse.csr_matrix((values, (rows, columns)), (2 * coarse + 1, coarse + 1))


def interpolation(coarse_shape):
    x, y, z = (line_interpolation(n) for n in coarse_shape)
    return sparse.kron(sparse.kron(sparse.kron(x, y), z), sparse.identity(3), format="csr")


class Chebyshev:
    """Smooths by a polynomial of D^-1 A that is small over the upper part of the spectrum; symmetric."""

    def __init__(self, apply, diagonal, free, degree=3):
        self.apply, self.degree = apply, degree
        self.inverse = np.where(free, 1 / np.where(diagonal > 0, diagonal, 1), 0)
        vector = np.random.default_rng(1).standard_normal(len(diagonal)) * (self.inverse > 0)
        for _ in range(8):
            vector /= np.linalg.norm(vector)
            vector = self.inverse * apply(vector)
        self.largest = 1.1 * np.linalg.norm(vector)

    def __call__(self, right, start=None):
        high, low = self.largest, self.largest / 12
        middle, half = (high + low) / 2, (high - low) / 2
        rest = right if start is None else right - self.apply(start)
        rho = half / middle
        step = self.inverse * rest / middle
        x = step.copy() if start is None else start + step
        for _ in range(self.degree - 1):
            rest = right - self.apply(x)
            next_rho = 1 / (2 * middle / half - rho)
            step = next_rho * rho * step + 2 * next_rho / half * (self.inverse * rest)
            x += step
            rho = next_rho
        return x


class Level:
    def __init__(self, apply, diagonal, free):
        self.free = free & (diagonal > 0)
        self.apply = lambda v: np.where(self.free, apply(v), 0)
        self.smooth = Chebyshev(self.apply, diagonal, self.free)


def assembled(elements, dofs, count):
    rows = np.repeat(dofs, 24, axis=1).ravel()
    columns = np.tile(dofs, (1, 24)).ravel()
    return sparse.csr_matrix((elements.reshape(-1), (rows, columns)), (count, count))


class Block:
    """A box of voxels with material in `density` (0..1, relative Young's modulus) of each. Its edges are powers of two,
    or multiples of them, voxels long."""

    LARGEST_DIRECT = 13 ** 3 * 3  # unknowns

    def __init__(self, density, poisson=0.35):
        self.shape = density.shape
        self.unit = element_matrix(poisson)
        self.density = density.reshape(-1)
        self.active = np.flatnonzero(self.density)
        self.weights = self.density[self.active]
        self.dofs = dof_numbers(node_numbers(self.shape)[self.active])
        self.count = 3 * int(np.prod(np.array(self.shape) + 1))
        self.diagonal = self.gather(self.weights[:, None] * np.diag(self.unit)[None])
        self.coarse = self.coarse_matrices()

    def gather(self, values):
        return np.bincount(self.dofs.reshape(-1), values.reshape(-1), self.count)

    def apply(self, displacement):
        return self.gather(displacement[self.dofs] @ self.unit * self.weights[:, None])

    def coarse_matrices(self):
        """Galerkin's: an element of twice the edge is the sum of its children. [(matrix, interpolation to finer)]"""
        maps, shape, levels = halves(), self.shape, []
        elements = None
        while 3 * np.prod(np.array(shape) + 1) > self.LARGEST_DIRECT and all(n % 2 == 0 for n in shape):
            coarse = tuple(n // 2 for n in shape)
            index = np.arange(int(np.prod(shape))).reshape(shape)
            parents = np.zeros((int(np.prod(coarse)), 24, 24), np.float32)
            for corner, change in zip(CORNERS, maps):
                children = index[corner[0]::2, corner[1]::2, corner[2]::2].reshape(-1)
                if elements is None:
                    parents += self.density[children, None, None] * (change.T @ self.unit @ change).astype(np.float32)
                else:
                    small = change.astype(np.float32)
                    parents += small.T @ elements[children] @ small
            count = 3 * int(np.prod(np.array(coarse) + 1))
            matrix = assembled(parents.astype(np.float64), dof_numbers(node_numbers(coarse)), count)
            levels.append((coarse, matrix, interpolation(coarse)))
            elements, shape = parents, coarse
        return levels

    def hierarchy(self, fixed_of):
        """fixed_of(shape): which unknowns are given."""
        levels = [Level(self.apply, self.diagonal, ~fixed_of(self.shape))]
        for shape, matrix, _ in self.coarse:
            levels.append(Level(matrix.dot, matrix.diagonal(), ~fixed_of(shape)))
        matrix = self.coarse[-1][1] if self.coarse else None
        direct = None
        if matrix is not None:
            free = sparse.diags(levels[-1].free.astype(float))
            direct = splu((free @ matrix @ free + sparse.diags(np.where(levels[-1].free, 1e-9, 1.0))).tocsc())
        return levels, direct

    def preconditioner(self, levels, direct):
        def cycle(depth, right):
            level = levels[depth]
            if depth == len(levels) - 1 and direct is not None:
                return np.where(level.free, direct.solve(right), 0)
            x = level.smooth(right)
            if depth + 1 < len(levels):
                up = self.coarse[depth][2]
                rest = right - level.apply(x)
                change = cycle(depth + 1, np.where(levels[depth + 1].free, up.T @ rest, 0))
                x = x + np.where(level.free, up @ change, 0)
                x = level.smooth(right, x)
            return x
        return lambda right: cycle(0, right)

    def energy(self, affine, fixed_of, tolerance=1e-4):
        """Twice the energy per volume of what `affine` (3 x 3, displacement from place in units of a voxel) is imposed on."""
        levels, direct = self.hierarchy(fixed_of)
        places = np.stack(np.meshgrid(*(np.arange(n + 1.0) for n in self.shape), indexing="ij"), axis=-1).reshape(-1, 3)
        start = (places @ np.asarray(affine, float).T).reshape(-1)
        free = levels[0].free
        right = np.where(free, -self.apply(start), 0)
        operator = LinearOperator((self.count,) * 2, lambda v: levels[0].apply(v))
        helper = LinearOperator((self.count,) * 2, self.preconditioner(levels, direct))
        steps = []
        change, failed = (right, 0) if not right.any() else cg(
            operator, right, M=helper, tol=tolerance, atol=0, maxiter=400, callback=lambda _: steps.append(1))
        if failed:
            raise ArithmeticError("no convergence in %d steps" % len(steps))
        self.steps = len(steps)
        result = start + np.where(free, change, 0)
        return result @ self.apply(result) / np.prod(self.shape)


def node_grid(shape):
    return np.stack(np.meshgrid(*(np.arange(n + 1) for n in shape), indexing="ij"), axis=-1).reshape(-1, 3)


def youngs_modulus(block, axis, tolerance=1e-4):
    """Between two smooth rigid plates, sides free; relative to the material's."""
    others = [i for i in range(3) if i != axis]

    def fixed(shape):
        nodes = node_grid(shape)
        given = np.zeros((len(nodes), 3), bool)
        given[:, axis] = (nodes[:, axis] == 0) | (nodes[:, axis] == shape[axis])
        # The rest of a rigid motion: two nodes of one edge.
        bottom = (nodes[:, axis] == 0) & (nodes[:, others[1]] == 0)
        given[bottom & (nodes[:, others[0]] == 0)] = True
        given[bottom & (nodes[:, others[0]] == shape[others[0]]), others[1]] = True
        return given.reshape(-1)

    affine = np.zeros((3, 3))
    affine[axis, axis] = -1
    return block.energy(affine, fixed, tolerance)


def shear_modulus(block, tolerance=1e-4):
    """All faces sheared in x by z as if they were one; relative to the material's Young's modulus."""
    def fixed(shape):
        nodes = node_grid(shape)
        outer = ((nodes == 0) | (nodes == np.array(shape))).any(axis=1)
        return np.repeat(outer, 3)

    affine = np.zeros((3, 3))
    affine[0, 2] = 1
    return block.energy(affine, fixed, tolerance)

"""The phantom: a cube of gel whose surface points are those of a grid of 3 x 3 squares on each face."""

import itertools

import numpy as np
from scipy.spatial import ConvexHull


def grid(side, cells):
    """Points of the surface grid, shape (n, 3), and which coordinates each may change, shape (n, 3)."""
    ticks = np.array([p for p in itertools.product(range(cells + 1), repeat=3) if any(c in (0, cells) for c in p)])
    return side * ticks / cells, (ticks > 0) & (ticks < cells)


def triangles(points, side, rng):
    """Outward triangles of the grid; the diagonals fall by lot."""
    lifted = points - side / 2
    radius = np.sqrt((lifted**2).sum(axis=1))[:, None]
    noise = 1 + 1e-3 * rng.random((len(points), 1))
    hull = ConvexHull(lifted / radius * noise)  # on a sphere: the same neighbours, diagonals by the noise
    faces = hull.simplices.copy()
    p = lifted[faces]
    inward = np.linalg.det(p) < 0
    faces[inward] = faces[inward][:, ::-1]
    return faces


class Slide:
    """Lets points on faces slide in them and points on edges along them; corners rest."""

    def __init__(self, mesh, free):
        self.mesh, self.free = mesh, free

    def carry(self, i, steps):
        return self.mesh.points[i] + steps * self.free[i]

    def settle(self, i, k):
        """Nothing to remember: the place is the point's own."""

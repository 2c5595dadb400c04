"""From a closed surface and inner points to good tetrahedra of a wanted number."""

import pathlib
import subprocess
import tempfile

import numpy as np
from scipy.spatial import cKDTree

from tetrahedra import Mesh, cross, dihedral_angles, energy


def inside(points, places, triangles):
    """Which of `points` lie inside the closed surface: solid angles add up to 4 pi."""
    a, b, c = (places[triangles[:, k]][None] - points[:, None] for k in range(3))
    la, lb, lc = (np.linalg.norm(x, axis=2) for x in (a, b, c))
    det = np.einsum("nti,nti->nt", a, np.cross(b, c))
    dot = (la * lb * lc + np.einsum("nti,nti->nt", a, b) * lc + np.einsum("nti,nti->nt", b, c) * la
           + np.einsum("nti,nti->nt", c, a) * lb)
    return np.arctan2(det, dot).sum(axis=1) > np.pi


def inner_points(places, triangles, count, distance, rng):
    """`count` points inside, far from each other and at least about `distance` from the surface."""
    low, high = places.min(axis=0), places.max(axis=0)
    trial = low + (high - low) * rng.random((20000, 3))
    split = np.array([(i, j, 4 - i - j) for i in range(5) for j in range(5 - i)]) / 4.0
    skin = np.einsum("kc,tcx->tkx", split, places[triangles]).reshape(-1, 3)
    gap = cKDTree(skin).query(trial)[0]
    trial, gap = trial[gap > distance], gap[gap > distance]
    keep = inside(trial, places, triangles)
    trial, gap = trial[keep], gap[keep]
    chosen = []
    near = 1.3 * gap
    for _ in range(count):
        k = int(near.argmax())
        chosen.append(trial[k])
        near = np.minimum(near, np.linalg.norm(trial - trial[k], axis=1))
    chosen = np.array(chosen)
    for _ in range(30):  # each point to the middle of what lies nearest to it
        owner = cKDTree(chosen).query(trial)[1]
        sums = np.stack([np.bincount(owner, trial[:, k], count) for k in range(3)], axis=1)
        chosen = sums / np.bincount(owner, minlength=count)[:, None]
    return chosen


def tetgen(places, triangles, inner):
    """Delaunay tetrahedra with the surface kept; the points in the order given."""
    with tempfile.TemporaryDirectory() as folder:
        base = pathlib.Path(folder) / "body"
        rows = [f"{len(places)} 3 0 0"]
        rows += [f"{i} {p[0]:.17g} {p[1]:.17g} {p[2]:.17g}" for i, p in enumerate(places)]
        rows += [f"{len(triangles)} 0"] + [f"3 {a} {b} {c}" for a, b, c in triangles] + ["0", "0"]
        base.with_suffix(".smesh").write_text("\n".join(rows) + "\n")
        rows = [f"{len(inner)} 3 0 0"]
        rows += [f"{i} {p[0]:.17g} {p[1]:.17g} {p[2]:.17g}" for i, p in enumerate(inner)]
        base.with_suffix(".a.node").write_text("\n".join(rows) + "\n")
        if subprocess.run(["tetgen", "-pYiQ", "body.smesh"], cwd=folder, stdout=subprocess.DEVNULL).returncode:
            raise SystemExit("TetGen fails: does the surface cross itself?")
        read = [np.array([line.split() for line in (pathlib.Path(folder) / f"body.1.{end}").read_text().splitlines()[1:]
                          if line and not line.startswith("#")], float) for end in ("node", "ele")]
    points, tets = read[0][:, 1:4], read[1][:, 1:5].astype(int)
    if len(points) != len(places) + len(inner):
        raise SystemExit("TetGen needs more points than those given")
    x = points[tets]
    wrong = np.linalg.det(x[:, 1:] - x[:, :1]) < 0
    tets[wrong] = tets[wrong][:, [0, 2, 1, 3]]
    return Mesh(points, tets)


class Smoother:
    """Moves one point after the other to where the energy of its tetrahedra is lowest of some trials.

    `carry(i, steps)` gives the places of surface point i after small steps in space, `settle(i, k)` is told which
    was taken. `size` is the edge aimed at; `skin_weight` is what even surface triangles count beside tetrahedra.
    """

    def __init__(self, mesh, size, carry, settle, skin_weight=1.0):
        self.mesh, self.carry, self.settle, self.skin_weight = mesh, carry, settle, skin_weight
        self.reach = np.full(len(mesh.points), 0.1 * size)
        self.size = size

    def sweep(self, rng, trials=16):
        """Each point once; a point that finds nothing better tries smaller steps the next time."""
        mesh = self.mesh
        tets = np.array(mesh.tets)
        star = [[] for _ in mesh.points]
        for t, tet in enumerate(mesh.tets):
            for k, i in enumerate(tet):
                star[i].append((t, k))
        skin = [[] for _ in mesh.points]
        for face in mesh.surface():
            for k, i in enumerate(face):
                skin[i].append((face[(k + 1) % 3], face[(k + 2) % 3]))
        for i in range(len(mesh.points)):
            step = rng.standard_normal((trials, 3)) * self.reach[i]
            step[0] = 0
            places = self.carry(i, step) if skin[i] else mesh.points[i] + step
            t, k = (np.array(c) for c in zip(*star[i]))
            x = np.broadcast_to(mesh.points[tets[t]], (trials, len(t), 4, 3)).copy()
            x[:, np.arange(len(t)), k] = places[:, None]
            cost = energy(x).sum(axis=1)
            if skin[i]:
                a, b = (mesh.points[np.array(c)] - places[:, None] for c in zip(*skin[i]))
                cost = cost + self.skin_weight * self._skin_energy(a, b).sum(axis=1)
            best = int(cost.argmin())
            self.reach[i] = max(1e-4 * self.size, self.reach[i] * 0.8) if best == 0 else \
                min(0.15 * self.size, self.reach[i] * 1.3)
            if best:
                mesh.points[i] = places[best]
                if skin[i]:
                    self.settle(i, best)

    def _skin_energy(self, a, b):
        """Of triangles with edges a, b: 1 for the even one of the mean size, more for others."""
        n = cross(a, b)
        area = np.maximum(0.5 * np.sqrt((n * n).sum(axis=-1)), 1e-12 * self.size**2)
        shape = ((a * a).sum(-1) + (b * b).sum(-1) + ((a - b) ** 2).sum(-1)) / (4 * np.sqrt(3) * area)
        ideal = np.sqrt(3) / 4 * self.size**2
        return shape * shape + 1.5 * (area / ideal + ideal / area - 2)


def quality(mesh):
    """Smallest and largest dihedral angle [degrees]."""
    angles = dihedral_angles(mesh.corners())
    return float(angles.min()), float(angles.max())


def improve(mesh, smoother, wanted, rng, rounds, heat, log=None):
    """Flips and smooths in turn while cooling; a price on each tetrahedron (a reward where negative) steers their number to `wanted`.

    The mesh ends as the best of that number that came by. Prints every `log` rounds.
    """
    price, best = 0.0, None
    for turn in range(rounds):
        price += 0.1 * (len(mesh.tets) - wanted)
        mesh.flip_pass(rng, price, heat * max(0.0, 1 - 1.3 * turn / rounds))
        smoother.sweep(rng)
        total = float(energy(mesh.corners()).sum())
        if len(mesh.tets) == wanted and (best is None or total < best[0]):
            best = (total, mesh.points.copy(), list(mesh.tets))
        if log and turn % log == 0:
            print(f"  {turn:4d} tetrahedra {len(mesh.tets)} price {price:6.2f} energy {total:9.1f} "
                  f"angles {quality(mesh)[0]:5.2f} {quality(mesh)[1]:6.2f}", flush=True)
    if best is None:
        raise SystemExit(f"never met {wanted} tetrahedra")
    _, mesh.points, mesh.tets = best

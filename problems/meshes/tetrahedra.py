"""Tetrahedra with fixed surface and points that may move: energies, flips, smoothing.

The energy of a tetrahedron is the mean of 1 / sin^4 over its six dihedral angles plus a size-free ratio of
edge lengths to volume; it is 2 for the regular one and infinite for a flat or inverted one. Only the four
operations and square roots are used, so that decisions do not depend on a mathematical library.
"""

import itertools

import numpy as np

FACES = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))  # outward when the tetrahedron is positive
EDGES = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))


def cross(a, b):
    return np.stack([a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1], a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2],
                     a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]], axis=-1)


def _dot(a, b):
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def _measures(x):
    """Six-fold volume, squared double face areas (opposite each corner) and squared edges of x (..., 4, 3)."""
    e01, e02, e03 = x[..., 1, :] - x[..., 0, :], x[..., 2, :] - x[..., 0, :], x[..., 3, :] - x[..., 0, :]
    e12, e13 = e02 - e01, e03 - e01
    n3, n2, n1, n0 = cross(e01, e02), cross(e01, e03), cross(e02, e03), cross(e12, e13)
    det = _dot(n3, e03)
    areas = [_dot(n, n) for n in (n0, n1, n2, n3)]
    edges = [_dot(e, e) for e in (e01, e02, e03, e12, e13, e03 - e02)]
    return det, areas, edges


def energy(x):
    """Energy of the tetrahedra with corners x, shape (..., 4, 3)."""
    det, areas, edges = _measures(x)
    with np.errstate(all="ignore"):
        # sin = 3 V L / (2 A A') at the edge of length L between faces of area A, A'
        inverse = [areas[k] * areas[l] / (det * det * edges[e])
                   for e, (k, l) in enumerate(((2, 3), (1, 3), (1, 2), (0, 3), (0, 2), (0, 1)))]
        angular = sum(i * i for i in inverse) * (64.0 / 81.0 / 6.0)
        ratio = sum(edges) ** 3 / (432.0 * det * det)
        return np.where(det > 0, angular + ratio, np.inf)


def dihedral_angles(x):
    """Six dihedral angles of each tetrahedron in degrees, shape (..., 6)."""
    normals = [cross(x[..., f[1], :] - x[..., f[0], :], x[..., f[2], :] - x[..., f[0], :]) for f in FACES]
    normals = [n / np.sqrt(_dot(n, n))[..., None] for n in normals]
    return np.stack([180 - np.degrees(np.arccos(np.clip(_dot(normals[k], normals[l]), -1, 1)))
                     for k, l in itertools.combinations(range(4), 2)], axis=-1)


def volumes(x):
    return _measures(x)[0] / 6


def _fans(n):
    """Ways to cut a polygon of corners 0..n-1 into triangles."""
    def cut(i, j):
        if j - i < 2:
            return [()]
        return [((i, k, j),) + a + b for k in range(i + 1, j) for a in cut(i, k) for b in cut(k, j)]
    return cut(0, n - 1)


TRIANGLES = {n: list(itertools.combinations(range(n), 3)) for n in range(3, 8)}
FANS = {n: np.array([[TRIANGLES[n].index(t) for t in fan] for fan in _fans(n)]) for n in range(3, 8)}


class Mesh:
    def __init__(self, points, tetrahedra):
        self.points = np.array(points, float)
        self.tets = [tuple(int(i) for i in t) for t in tetrahedra]

    def corners(self):
        return self.points[np.array(self.tets)]

    def faces(self):
        """Each face once: sorted corners -> list of tetrahedra."""
        found = {}
        for t, tet in enumerate(self.tets):
            for f in FACES:
                found.setdefault(tuple(sorted(tet[i] for i in f)), []).append(t)
        return found

    def surface(self):
        """Outward triangles of the surface."""
        found = {}
        for tet in self.tets:
            for f in FACES:
                face = tuple(tet[i] for i in f)
                found.setdefault(tuple(sorted(face)), []).append(face)
        return [f[0] for f in found.values() if len(f) == 1]

    def edges(self):
        """Each edge once: (a, b), a < b -> list of (tetrahedron, c, d) with (a, b, c, d) positive."""
        found = {}
        for t, (p, q, r, s) in enumerate(self.tets):
            for a, b, c, d in ((p, q, r, s), (p, r, s, q), (p, s, q, r), (q, r, p, s), (q, s, r, p), (r, s, p, q)):
                found.setdefault((a, b) if a < b else (b, a), []).append((t, c, d) if a < b else (t, d, c))
        return found

    def counts(self):
        """Points, tetrahedra, edges, surface points, surface triangles."""
        surface = self.surface()
        return (len(self.points), len(self.tets), len(self.edges()), len({i for f in surface for i in f}),
                len(surface))

    def _flat(self, a, b, c, d):
        """Whether the edge (a, b) of the surface between corners c and d may turn there: all in one plane."""
        u, v, w = (self.points[i] - self.points[a] for i in (b, c, d))
        scale = np.sqrt(_dot(u, u) * _dot(v, v) * _dot(w, w))
        return abs(_dot(cross(u, v), w)) < 1e-9 * scale

    def flips(self):
        """Every replacement of tetrahedra inside the mesh by others: (change of energy, old, new)."""
        old = energy(self.corners())
        result = []
        rings = {n: [] for n in FANS}
        for (a, b), around in self.edges().items():
            follow = {c: (d, t) for t, c, d in around}
            ends = {d for d, _ in follow.values()}
            heads = [c for c in follow if c not in ends]  # one where the edge lies on the surface
            at = heads[0] if heads else min(follow)
            ring, ids = [at], []
            while len(ids) < len(around) and at in follow:
                at, t = follow[at]
                ring.append(at)
                ids.append(t)
            if not heads:
                ring.pop()
            if len(ids) == len(around) and len(ring) in FANS and (not heads or self._flat(a, b, ring[0], ring[-1])):
                rings[len(ring)].append((a, b, ring, ids))
        for n, found in rings.items():
            if not found:
                continue
            ring = np.array([r for _, _, r, _ in found])
            ends = np.array([(a, b) for a, b, _, _ in found])
            tri = ring[:, np.array(TRIANGLES[n])]                                    # (edges, triangles, 3)
            top = np.concatenate([tri, np.broadcast_to(ends[:, None, 1:], tri.shape[:2] + (1,))], axis=-1)
            bottom = np.concatenate([tri[..., [0, 2, 1]], np.broadcast_to(ends[:, None, :1], tri.shape[:2] + (1,))],
                                    axis=-1)
            cost = energy(self.points[top]) + energy(self.points[bottom])
            fans = cost[:, FANS[n]].sum(axis=2)
            best = fans.argmin(axis=1)
            for k, (_, _, _, ids) in enumerate(found):
                change = fans[k, best[k]] - old[ids].sum()
                if change < np.inf:
                    pick = FANS[n][best[k]]
                    result.append((change, ids, [*map(tuple, top[k, pick]), *map(tuple, bottom[k, pick])]))
        pairs, new = [], []
        for face, ids in self.faces().items():
            if len(ids) == 2:
                tet = self.tets[ids[0]]
                i = next(i for i in range(4) if tet[i] not in face)
                far = next(v for v in self.tets[ids[1]] if v not in face)
                a, b, c = (tet[j] for j in FACES[i])
                near = tet[i]
                pairs.append(ids)
                new.append([(near, a, b, far), (near, b, c, far), (near, c, a, far)])
        change = energy(self.points[np.array(new)]).sum(axis=1) - old[np.array(pairs)].sum(axis=1)
        result += [(change[k], pairs[k], new[k]) for k in np.flatnonzero(change < np.inf)]
        return result

    def apply(self, chosen):
        gone = {t for _, ids, _ in chosen for t in ids}
        self.tets = [t for i, t in enumerate(self.tets) if i not in gone]
        self.tets += [tuple(int(i) for i in t) for _, _, new in chosen for t in new]

    def flip_pass(self, rng, price=0.0, heat=0.0):
        """Replaces where energy + price * count falls (or rises by no more than the heat allows)."""
        scored = [(c + price * (len(n) - len(o)), k, (c, o, n)) for k, (c, o, n) in enumerate(self.flips())]
        luck = heat * -np.log(rng.random(len(scored))) if heat else np.zeros(len(scored))
        scored = [s for s in scored if s[0] < luck[s[1]] - 1e-9]
        if heat:
            rng.shuffle(scored)
        else:
            scored.sort(key=lambda s: s[:2])
        used, chosen = set(), []
        for _, _, flip in scored:
            if used.isdisjoint(flip[1]):
                used.update(flip[1])
                chosen.append(flip)
        self.apply(chosen)
        return len(chosen)

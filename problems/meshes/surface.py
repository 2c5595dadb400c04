"""Even triangles on a shape of two sheets: the points slide, edges flip, their number stays.

A shape offers points(disc, sheet): places in space of places (n, 2) in the unit disc on the sheets (n,), which
are +1 and -1 inside and 0 on the common margin, the unit circle.
"""

import numpy as np
from scipy.spatial import Delaunay

STEP = 1e-5  # of the differences that give tangents, in the disc


def _dot(a, b):
    return (a * b).sum(axis=-1)


def _slide_inside(shape, disc, sheet, wish):
    """Disc places after steps `wish` (n, 3) in space from disc (n, 2) or (1, 2), off the margin."""
    along = [(shape.points(disc + s, sheet) - shape.points(disc - s, sheet)) / (2 * STEP)
             for s in (np.array([STEP, 0]), np.array([0, STEP]))]
    aa, ab, bb = _dot(along[0], along[0]), _dot(along[0], along[1]), _dot(along[1], along[1])
    wa, wb = _dot(along[0], wish), _dot(along[1], wish)
    det = aa * bb - ab * ab + 1e-9 * (aa + bb)
    moved = disc + np.stack([(bb * wa - ab * wb) / det, (aa * wb - ab * wa) / det], axis=-1)
    return moved * np.minimum(1, 0.985 / np.hypot(moved[:, :1], moved[:, 1:]))


def _slide_margin(shape, disc, wish):
    """The same on the margin, where only the angle moves."""
    def on_circle(c):
        return c / np.hypot(c[:, :1], c[:, 1:])
    turn = np.stack([-disc[:, 1], disc[:, 0]], axis=-1)
    sheet = np.zeros(len(disc), int)
    along = (shape.points(on_circle(disc + STEP * turn), sheet)
             - shape.points(on_circle(disc - STEP * turn), sheet)) / (2 * STEP)
    return on_circle(disc + turn * (_dot(along, wish) / _dot(along, along))[:, None])


def slide(shape, disc, sheet, wish):
    """Disc places after a step `wish` (n, 3) in space, along the surface only; margin points stay on it."""
    moved, on = np.empty_like(disc), sheet == 0
    moved[~on] = _slide_inside(shape, disc[~on], sheet[~on], wish[~on])
    moved[on] = _slide_margin(shape, disc[on], wish[on])
    return moved


def triangles_of(disc, sheet):
    """Delaunay triangles of both sheets in the disc, outward."""
    both = []
    for sign in (1, -1):
        ids = np.flatnonzero((sheet == sign) | (sheet == 0))
        tri = ids[Delaunay(disc[ids]).simplices]
        wrong = (_turn(disc[tri]) > 0) != (sign > 0)
        tri[wrong] = tri[wrong][:, ::-1]
        both.append(tri)
    return np.vstack(both)


def _turn(p):
    return ((p[..., 1, 0] - p[..., 0, 0]) * (p[..., 2, 1] - p[..., 0, 1])
            - (p[..., 1, 1] - p[..., 0, 1]) * (p[..., 2, 0] - p[..., 0, 0]))


def _cotangents(places, triangles):
    """Of the angles at the three corners of each triangle, shape (n, 3)."""
    p = places[triangles]
    found = []
    for k in range(3):
        u, v = p[:, (k + 1) % 3] - p[:, k], p[:, (k + 2) % 3] - p[:, k]
        found.append(_dot(u, v) / np.linalg.norm(np.cross(u, v), axis=1))
    return np.stack(found, axis=1)


def flip_to_delaunay(places, disc, sheet, triangles):
    """Flips edges whose opposite angles in space exceed 180 degrees together, where the disc allows it."""
    tri = [tuple(int(i) for i in t) for t in triangles]
    for _ in range(20):
        owner = {}
        for k, ((a, b, c), (at_a, at_b, at_c)) in enumerate(zip(tri, _cotangents(places, np.array(tri)).tolist())):
            owner[a, b], owner[b, c], owner[c, a] = (k, c, at_c), (k, a, at_a), (k, b, at_b)
        touched, flipped = set(), 0
        for (a, b), (k, c, at_c) in sorted(owner.items()):
            l, d, at_d = owner[b, a]
            if a > b or at_c + at_d > -1e-6 or k in touched or l in touched or (c, d) in owner or (d, c) in owner \
                    or (sheet[a] == 0 and sheet[b] == 0):
                continue
            sign = 1 if (sheet[a] or sheet[b]) > 0 else -1
            new = [(a, d, c), (d, b, c)]
            if min(sign * _turn(disc[np.array(new)])) <= 1e-6:
                continue
            tri[k], tri[l] = new
            touched.update((k, l))
            flipped += 1
        if not flipped:
            break
    return np.array(tri)


def even(shape, disc, sheet, rounds):
    """Slides the points until the triangles are of even size; returns disc places and triangles."""
    triangles = triangles_of(disc, sheet)
    margin = np.flatnonzero(sheet == 0)
    for turn in range(rounds):
        places = shape.points(disc, sheet)
        triangles = flip_to_delaunay(places, disc, sheet, triangles)
        p = places[triangles]
        area = np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1)
        weight, centre = np.zeros(len(places)), np.zeros_like(places)
        for k in range(3):
            np.add.at(weight, triangles[:, k], area**2)  # squared: points flow to where triangles are large
            np.add.at(centre, triangles[:, k], (area**2)[:, None] * p.mean(axis=1))
        wish = 0.6 * (centre / weight[:, None] - places)
        order = margin[np.argsort(np.arctan2(disc[margin, 1], disc[margin, 0]))]
        wish[order] = 0.3 * (places[np.roll(order, 1)] + places[np.roll(order, -1)] - 2 * places[order])
        longest = np.linalg.norm(wish, axis=1).max()
        wish *= min(1, 0.5 * np.sqrt(area.mean()) / longest)
        new = slide(shape, disc, sheet, wish)
        # a step may not turn a triangle over in the disc
        for _ in range(8):
            sign = np.where(np.any(sheet[triangles] > 0, axis=1), 1, -1)
            bad = sign * _turn(new[triangles]) < 1e-5
            if not bad.any():
                break
            hit = np.unique(triangles[bad])
            new[hit] = 0.5 * (new[hit] + disc[hit])
            on = hit[sheet[hit] == 0]
            new[on] /= np.hypot(new[on, :1], new[on, 1:])
        else:
            continue
        disc = new
    places = shape.points(disc, sheet)
    return disc, flip_to_delaunay(places, disc, sheet, triangles)


def start(shape, count, margin, upper):
    """First disc places: `margin` points on the circle, `upper` of the others on the dome, the rest below."""
    sheet = np.concatenate([np.zeros(margin, int), np.ones(upper, int), -np.ones(count - margin - upper, int)])
    fine = np.linspace(0, 2 * np.pi, 2001)
    walk = shape.points(np.stack([np.cos(fine), np.sin(fine)], axis=-1), np.zeros(2001, int))
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(walk, axis=0), axis=1))])
    angle = np.interp(np.arange(margin) * length[-1] / margin, length, fine)
    parts = [np.stack([np.cos(angle), np.sin(angle)], axis=-1)]
    for n in (upper, count - margin - upper):
        k = np.arange(n) + 0.5
        r, golden = 0.93 * np.sqrt(k / n), k * np.pi * (3 - np.sqrt(5))
        parts.append(np.stack([r * np.cos(golden), r * np.sin(golden)], axis=-1))
    return np.vstack(parts), sheet


class Skin:
    """The surface points of a mesh under way: where each goes when it is pushed along the shape."""

    def __init__(self, shape, disc, sheet):
        self.shape, self.disc, self.sheet = shape, disc.copy(), sheet
        self._trial = None

    def carry(self, i, steps):
        """Places (n, 3) of point i after the steps (n, 3); a step of zero leaves it where it is."""
        here, sheet = self.disc[i : i + 1], self.sheet[i : i + 1]
        self._trial = _slide_inside(self.shape, here, sheet, steps) if sheet[0] else \
            _slide_margin(self.shape, here, steps)
        self._trial[0] = here[0]
        return self.shape.points(self._trial, np.full(len(steps), sheet[0]))

    def settle(self, i, k):
        """Point i stays where step k of the last `carry` took it."""
        self.disc[i] = self._trial[k]

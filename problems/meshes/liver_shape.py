"""The shape of the liver: a dome and a hollow over one outline, in two sheets.

Patient axes: x to the left, y to the back, z up (right lobe at negative x). Lengths are in centimetres here;
make.py scales the whole to the volume asked for.

A point of the surface has a place (a, b) in the unit disc and a sheet: +1 the dome below the diaphragm, -1
the visceral face, 0 the margin between them (the circle a^2 + b^2 = 1). The margin is sharp in front and to
the left and round behind the right lobe.
"""

import math

import numpy as np
from scipy.interpolate import CubicSpline

# Outline seen from the front: angle about CENTRE is free, the points go round once. Third number: how sharp
# the margin is there, 0 (round) to 1 (a wedge).
CENTRE = np.array([-4.0, 0.0])
OUTLINE = np.array([
    (-11.2, -0.5, 0.15), (-10.9, -4.5, 0.6), (-8.6, -8.2, 1.0), (-4.6, -7.4, 1.0), (-1.2, -5.4, 1.0),
    (0.6, -4.1, 1.0), (3.4, -4.0, 1.0), (6.4, -2.4, 1.0), (9.3, 0.8, 1.0), (9.8, 3.2, 1.0),
    (7.6, 4.3, 0.8), (4.0, 4.1, 0.5), (0.5, 4.6, 0.25), (-3.5, 6.6, 0.0), (-7.5, 6.6, 0.0), (-10.3, 3.6, 0.0)])
TILT = math.radians(25)  # the dome looks up and to the front, the hollow down and to the back


def _bump(u, v, at, width):
    return np.exp(-((u - at[0]) / width[0]) ** 2 - ((v - at[1]) / width[1]) ** 2)


class Liver:
    """A shape for surface.py."""

    def __init__(self):
        rows = np.vstack([OUTLINE, OUTLINE[:1]])
        chord = np.hypot(*np.diff(rows[:, :2], axis=0).T)
        knots = np.concatenate([[0.0], np.cumsum(chord)])
        curve = CubicSpline(knots, rows, bc_type="periodic")
        fine = curve(np.linspace(0, knots[-1], 4001))[:-1]
        ray = fine[:, :2] - CENTRE
        angle = np.unwrap(np.arctan2(ray[:, 1], ray[:, 0]))
        order = np.argsort(np.mod(angle, 2 * np.pi))
        last, first = order[-1:], order[:1]  # repeated a turn away, so that tables need no period
        self._angle = np.concatenate([np.mod(angle[last], 2 * np.pi) - 2 * np.pi, np.mod(angle, 2 * np.pi)[order],
                                      np.mod(angle[first], 2 * np.pi) + 2 * np.pi])
        order = np.concatenate([last, order, first])
        self._radius = np.hypot(ray[:, 0], ray[:, 1])[order]
        self._sharp = np.clip(fine[order, 2], 0, 1)
        assert np.all(np.diff(np.unwrap(angle)) > 0), "the outline is not star-shaped about its centre"

    def points(self, disc, sheet):
        """Places in space, shape (n, 3), of disc places (n, 2) on sheets (n,)."""
        a, b = disc[..., 0], disc[..., 1]
        t = np.minimum(np.hypot(a, b), 1.0)
        angle = np.mod(np.arctan2(b, a), 2 * np.pi)
        radius = np.interp(angle, self._angle, self._radius)
        sharp = np.interp(angle, self._angle, self._sharp)
        sharp = sharp * t * t  # near the centre all rays agree
        reach = (1 - sharp) * np.sin(t * np.pi / 2) + sharp * t
        height = (1 - sharp) * np.cos(t * np.pi / 2) + sharp * (1 - t * t)
        u = CENTRE[0] + reach * radius * np.cos(angle)
        v = CENTRE[1] + reach * radius * np.sin(angle)
        dome = (8.0 - 0.12 * u) * height
        groove = 0.5 * _bump(u, 0, (1.0, 0), (1.4, 1)) * height          # the falciform ligament
        hollow = 5.2 * _bump(u, v, (0.5, -2.0), (7.5, 4.5)) * height**2      # porta, gall bladder and stomach
        bulge = 5.2 * _bump(u, v, (-6.5, 2.5), (7.0, 6.0)) * height       # the round back of the right lobe
        n = np.where(sheet > 0, dome - groove, np.where(sheet < 0, hollow - bulge - 0.4 * height, 0.0))
        n = n - 0.012 * (u + 2) ** 2  # the organ bends round the spine
        c, s = math.cos(TILT), math.sin(TILT)
        front, up = c * n - s * v, s * n + c * v
        return np.stack([u, -front, up], axis=-1)


"""Limits of steps written in Python, against closed forms."""

import json
import math
import os

import hmax
import numpy as np
import pytest
import scipy.sparse as sparse
from conftest import spring_chain

K, MASS, OMEGA = spring_chain(4)


def symplectic_euler(y, h):
    q, v = y[:4], y[4:]
    v = v - h * (K @ q) / MASS
    return np.concatenate([q + h * v, v])


class Engine:
    """A chain of springs that steps in place."""

    def __init__(self):
        self.q, self.v, self.steps = np.zeros(4), np.zeros(4), 0

    def step(self, y, h):
        self.steps += 1
        self.v -= h * (K @ self.q) / MASS
        self.q += h * self.v

    def save(self):
        return np.concatenate([self.q, self.v])

    def restore(self, y):
        self.q, self.v = y[:4].copy(), y[4:].copy()


def test_symplectic_euler_is_stable_up_to_two_over_omega():
    found = hmax.probe(symplectic_euler, np.zeros(8), h0=1e-3, h1=0.1)
    assert found.h_max == pytest.approx(2 / OMEGA[-1], rel=1e-3)
    assert found.observed == pytest.approx(2 / OMEGA[-1], rel=2e-3)
    assert found.state == "equilibrium" and found.dim == 8
    assert abs(found.gap) < 2e-3


@pytest.mark.parametrize("y0", [None, np.zeros(8)])
def test_an_engine_in_place_has_the_same_limit(y0):
    engine = Engine()
    found = hmax.probe(engine.step, y0, 1e-3, 0.1, save=engine.save, restore=engine.restore, verify=False)
    assert found.h_max == pytest.approx(2 / OMEGA[-1], rel=1e-3)
    assert found.observed is None
    assert (engine.save() == 0).all() and engine.steps > 10


def test_hidden_state_is_saved_and_restored():
    # A step that uses the acceleration of the step before, hidden beside y: what is said of it, and that runs show growth that no
    # derivative by y alone has.
    class Hidden:
        def __init__(self):
            self.a = np.zeros(1)

        def step(self, y, h):
            q, v = y
            v = v + h * self.a[0]
            q = q + h * v
            self.a = np.array([-100 * q])
            return [q, v]

        def save(self):
            return {"a": self.a.copy()}

        def restore(self, kept):
            self.a = kept["a"].copy()

    engine = Hidden()
    found = hmax.probe(engine.step, [0, 0], 1e-3, 1, save=engine.save, restore=engine.restore)
    assert "hidden state" in found.status and "runs contradict each other" in found.status and "grow from" in found.status
    assert (engine.a == 0).all()


def test_explicit_euler_of_a_damped_oscillator_has_its_closed_form():
    def step(y, h):
        return np.array([y[0] + h * y[1], y[1] + h * (-100 * y[0] - 2 * y[1])])

    assert hmax.probe(step, [0.0, 0.0], 1e-4, 0.1, verify=False).h_max == pytest.approx(2 / 100, rel=1e-3)


def test_a_step_that_grows_at_every_size_has_no_limit():
    found = hmax.probe(lambda y, h: y + h * np.array([y[1], -100 * y[0]]), [0.0, 0.0], 1e-6, 1)
    assert found.h_max is None and "no step size is stable: growth falls as h^2" in found.status and not found.contradiction


def test_a_step_without_growth_is_unbounded():
    found = hmax.probe(lambda y, h: y / (1 + 50 * h), [0.0], 1e-3, 10, verify=False)
    assert found.h_max == math.inf
    assert found.rows[0].spectral_radius == pytest.approx(1 / 1.05, rel=1e-6)


def test_single_precision_is_told_by_the_state():
    def step(y, h):
        y = y.astype(np.float32)
        v = y[1] - np.float32(h) * np.float32(100) * y[0]
        return np.array([y[0] + np.float32(h) * v, v], dtype=np.float32)

    found = hmax.probe(step, np.zeros(2, dtype=np.float32), 1e-2, 1, verify=False)
    assert found.h_max == pytest.approx(0.2, rel=1e-2)


def test_a_pattern_saves_steps():
    n = 60
    stiffness, mass, omega = spring_chain(n)
    calls = []

    def step(y, h):
        calls.append(h)
        v = y[n:] - h * (stiffness @ y[:n]) / mass
        return np.concatenate([y[:n] + h * v, v])

    ones, K = np.eye(n), stiffness != 0
    pattern = np.block([[K, ones], [K, ones]])
    limits, counts = [], []
    for given in (None, pattern, sparse.csr_matrix(pattern.astype(float))):
        calls.clear()
        limits.append(hmax.probe(step, np.zeros(2 * n), 1e-3, 0.1, pattern=given, verify=False).h_max)
        counts.append(len(calls))
    assert limits == pytest.approx([2 / omega[-1]] * 3, rel=1e-3)
    # Without a pattern the first matrix takes a step for each number, and tells the pattern of the others.
    assert counts[1] == counts[2] <= counts[0] - 2 * n


def test_quaternions_are_told_apart_from_numbers():
    def step(y, h):  # a spring, and a rotation that stays what it is
        v = y[1] - h * 100 * y[0]
        return np.concatenate([[y[0] + h * v, v], y[2:] / np.linalg.norm(y[2:])])

    found = hmax.probe(step, [0, 0, 0.6, 0, 0.8, 0], 1e-2, 1, quaternions=[2], verify=False)
    assert found.h_max == pytest.approx(0.2, rel=1e-3)
    with pytest.raises(ValueError, match="length 2 instead of 1"):
        hmax.probe(step, [0, 0, 2, 0, 0, 0], 1e-2, 1, quaternions=[2])


def test_growth_is_followed_along_a_motion():
    # x'' = -x^3 has no limit of its own at rest; along a motion symplectic Euler fails where h omega of the motion is near 2.
    def step(y, h):
        v = y[1] - h * y[0] ** 3
        return np.array([y[0] + h * v, v])

    found = hmax.probe(step, [1.0, 0.0], 1e-2, 0.1, motion=20.0, verify=False)
    assert found.state == "motion" and found.h_max == math.inf


def test_the_keys_are_those_of_the_program(program):
    library = os.environ.get("HMAX_PLUGIN", "")
    if not os.path.exists(library):
        pytest.skip("HMAX_PLUGIN names no plugin")
    told = json.loads(program("probe", "--plugin", library, "--h0", "1e-3", "--h1", "1", "--no-runs", "--json").stdout)
    assert list(hmax.probe(symplectic_euler, np.zeros(8), 1e-3, 0.1, verify=False)) == list(told)


@pytest.mark.parametrize(
    "given, words",
    [
        ({"step": 3}, "step is 3 but must be a function"),
        ({"step": lambda y, h: None}, "step returned None"),
        ({"step": lambda y, h: y[:1]}, "has 1 numbers but must have 2"),
        ({"step": lambda y, h: "x"}, "no real numbers"),
        ({"step": lambda y, h: y * np.nan}, "not finite"),
        ({"step": lambda y, h: y / 2}, "does not depend on its size"),
        ({"y0": None}, "y0 is missing"),
        ({"y0": []}, "no numbers"),
        ({"y0": [np.inf, 0]}, r"y0\[0\] is inf"),
        ({"y0": [[1.0]]}, "2 dimensions"),
        ({"h0": 0}, "two positive numbers"),
        ({"h0": 2.0}, "smaller one first"),
        ({"h0": None}, "give the step sizes"),
        ({"h1": np.nan}, "positive"),
        ({"motion": -1.0}, "motion"),
        ({"save": lambda: 0}, "belong together"),
        ({"scales": [1.0]}, "2 positive numbers"),
        ({"scales": [1.0, -1.0]}, "2 positive numbers"),
        ({"quaternions": ["a"]}, "an index of quaternions"),
        ({"pattern": np.eye(3)}, "shape 3 x 3 but must have 2 x 2"),
        ({"pattern": "x"}, "no real numbers"),
        ({"step": None}, "step is missing"),
        ({"quaternions": [0]}, "quaternions"),
    ],
)
def test_wrong_input_is_told(given, words):
    arguments = {"step": lambda y, h: y / (1 + h), "y0": [0.0, 0.0], "h0": 1e-3, "h1": 1.0}
    arguments.update(given)
    with pytest.raises(ValueError, match=words):
        hmax.probe(**arguments)

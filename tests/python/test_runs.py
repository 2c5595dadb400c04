"""Integration against closed forms and scipy."""

import hmax
import numpy as np
import pytest
import scipy.linalg as linalg
import scipy.sparse as sparse
from conftest import spring_chain
from scipy.integrate import solve_ivp


def van_der_pol(t, y):
    return np.array([y[1], 5 * (1 - y[0] ** 2) * y[1] - y[0]])


def van_der_pol_jacobian(t, y):
    return np.array([[0, 1], [-10 * y[0] * y[1] - 1, 5 * (1 - y[0] ** 2)]])


@pytest.fixture(scope="module")
def reference():
    return solve_ivp(van_der_pol, (0, 8), [2, 0], method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]


@pytest.mark.parametrize("method", ["ode45", "dop_853", "radau_iia_5", "rosenbrock_23", "ode113", "cvode_bdf"])
@pytest.mark.parametrize("with_jacobian", [False, True])
def test_adaptive_runs_reach_the_end_state_of_scipy(method, with_jacobian, reference):
    if not any(row.id == method or method in row.aliases for row in hmax.methods()):
        pytest.skip(f"this build has no {method}")
    rtol = 1e-6 if method == "rosenbrock_23" else 1e-9
    run = hmax.integrate(
        method, van_der_pol, [2, 0], 8, rtol=rtol, jacobian=van_der_pol_jacobian if with_jacobian else None
    )
    assert run.outcome == "reached_end"
    assert run.t[0] == 0 and run.t[-1] == 8
    assert run.y.shape == (len(run.t), 2)
    np.testing.assert_allclose(run.y[-1], reference, atol=3e4 * rtol)


def test_a_sparse_jacobian_gives_the_same_run():
    dense = hmax.integrate("radau_iia_5", van_der_pol, [2, 0], 2, rtol=1e-7, jacobian=van_der_pol_jacobian)
    scattered = hmax.integrate(
        "radau_iia_5", van_der_pol, [2, 0], 2, rtol=1e-7, jacobian=lambda t, y: sparse.csr_matrix(van_der_pol_jacobian(t, y))
    )
    np.testing.assert_allclose(scattered.y[-1], dense.y[-1], rtol=1e-9)
    assert dense.stats["jacobian"] > 0


def test_fixed_steps_of_rk4_are_those_of_its_formula():
    y, h = np.array([1.0, 0.0]), 0.1
    A = np.array([[0, 1], [-4, -0.2]])
    run = hmax.integrate("rk4", lambda t, y: A @ y, y, 1, h=h)
    z = h * A
    R = np.eye(2) + z + z @ z / 2 + z @ z @ z / 6 + z @ z @ z @ z / 24
    np.testing.assert_allclose(run.y, [np.linalg.matrix_power(R, i) @ y for i in range(11)], rtol=1e-12)
    assert run.stats["steps"] == 10 and run.stats["rhs"] == 40


@pytest.mark.parametrize("method", ["newmark", "central_difference", "rk4", "generalized_alpha"])
@pytest.mark.parametrize("coupled", [False, True])
def test_structures_follow_the_matrix_exponential(method, coupled):
    K, m, _ = spring_chain(4)
    M = np.diag(m) + (0.25 * (np.diag(m[1:], 1) + np.diag(m[1:], -1)) if coupled else 0)
    C = 0.5 * M + 1e-4 * K
    y0 = np.concatenate([[0.01, -0.02, 0.0, 0.005], [0.1, 0.0, -0.2, 0.0]])
    if coupled and method == "central_difference":
        with pytest.raises(ValueError, match="lumped masses"):
            hmax.integrate(method, K=K, M=M, C=C, y0=y0, t_end=0.1, h=1e-5)
        return
    run = hmax.integrate(method, K=sparse.csr_matrix(K), M=sparse.csr_matrix(M) if coupled else m, C=C, y0=y0, t_end=0.1, h=1e-5)
    inverse = np.linalg.inv(M)
    J = np.block([[np.zeros((4, 4)), np.eye(4)], [-inverse @ K, -inverse @ C]])
    np.testing.assert_allclose(run.y[0], y0, atol=1e-15)
    np.testing.assert_allclose(run.y[-1], linalg.expm(0.1 * J) @ y0, atol=1e-9 if method == "rk4" else 1e-4)


def test_points_are_kept_at_the_interval_that_is_asked_for():
    run = hmax.integrate("ode45", lambda t, y: -y, [1.0], 1, rtol=1e-10, every=0.25)
    np.testing.assert_allclose(run.t, [0, 0.25, 0.5, 0.75, 1])
    np.testing.assert_allclose(run.y[:, 0], np.exp(-run.t), rtol=1e-7)


def test_a_run_that_diverges_says_so():
    run = hmax.integrate("explicit_euler", lambda t, y: y**2, [1.0], 100, h=0.1)
    assert run.outcome == "diverged"
    assert np.isfinite(run.y).all()


@pytest.mark.parametrize(
    "given, words",
    [
        ({"rhs": None}, "K and the mass M, or rhs$"),
        ({"method": "rk44"}, "rk4"),
        ({"y0": None}, "y0 is missing"),
        ({"y0": [[1.0]]}, "2 dimensions"),
        ({"y0": [np.nan]}, r"y0\[0\] is nan"),
        ({"y0": ["a"]}, "no real numbers"),
        ({"t_end": None}, "t_end is missing"),
        ({"t_end": -1}, "before the start"),
        ({"t_end": np.nan}, "the end time"),
        ({"t_end": "x"}, "must be a number"),
        ({"h": None}, "give either h"),
        ({"rtol": 1e-3}, "give either h"),
        ({"h": 0}, "the step"),
        ({"h": 5.0}, "longer than the whole run"),
        ({"h": 1e-15}, "take a larger step or raise max_steps"),
        ({"h": None, "rtol": 1e-6}, "no error estimate"),
        ({"method": "newmark"}, "positions and velocities"),
        ({"every": -1}, "the output interval"),
        ({"K": np.eye(1)}, "both given"),
        ({"rhs": lambda t, y: [1.0, 2.0]}, "has 2 numbers but must have 1"),
        ({"rhs": [1.0]}, "rhs is .* but must be a function"),
        ({"jacobian": 3}, "jacobian is 3 but must be a function"),
        ({"rhs": lambda t, y: None}, "no real numbers"),
        ({"rhs": lambda t, y: [1j]}, "no real numbers"),
        ({"rhs": lambda t, y: [[1.0]]}, "2 dimensions"),
        ({"rhs": lambda t, y: [np.nan]}, "is nan at t = 0"),
        ({"method": "implicit_euler", "jacobian": lambda t, y: np.ones((2, 2))}, "shape 2 x 2 but must have 1 x 1"),
        ({"method": "implicit_euler", "jacobian": lambda t, y: "x"}, "no real numbers"),
    ],
)
def test_wrong_input_is_told(given, words):
    arguments = {"method": "rk4", "rhs": lambda t, y: -y, "y0": [1.0], "t_end": 1.0, "h": 0.1}
    arguments.update(given)
    with pytest.raises(ValueError, match=words):
        hmax.integrate(**arguments)


def test_a_start_of_another_size_than_the_matrices_is_told():
    with pytest.raises(ValueError, match="3 numbers but must have 4"):
        hmax.integrate("rk4", K=np.eye(2), M=[1, 1], y0=[0, 0, 0], t_end=1, h=0.1)

"""Methods, limits and modes against closed forms, numpy's eigenvalues and the program."""

import json
import math

import hmax
import numpy as np
import pytest
import scipy.linalg as linalg
import scipy.sparse as sparse
from conftest import spring_chain


def as_python(document):
    """A document of the program as the module has it."""
    if isinstance(document, dict):
        return {key: as_python(value) for key, value in document.items()}
    if isinstance(document, list):
        return [as_python(value) for value in document]
    return math.inf if document == "unbounded" else document


def test_methods_are_those_of_the_program(program):
    assert hmax.methods() == as_python(json.loads(program("list", "methods", "--json").stdout))


@pytest.mark.parametrize("method", ["rk4", "bdf_3", "newmark", "imex_ark_324", "adams_pece:order=4", "implicit_euler"])
def test_limits_are_those_of_the_program(program, method):
    told = program("stability", "limits", "--method", method, "--json").stdout
    assert hmax.limits(method) == as_python(json.loads(told))


def test_regions_are_those_of_the_program(program):
    told = as_python(json.loads(program("stability", "region", "--method", "rk4", "--cells", "50", "--json").stdout))
    found = hmax.region("rk4", cells=50)
    assert len(found.curves) == len(told["curves"])
    for ours, theirs in zip(found.curves, told["curves"]):
        np.testing.assert_array_equal(ours, theirs)
    assert found.about == told["about"] and found.window == told["window"]


def test_limits_of_euler_and_runge_kutta_are_the_published_ones():
    assert hmax.limits("explicit_euler").real == pytest.approx(2, rel=1e-12)
    assert hmax.limits("rk4").imaginary == pytest.approx(math.sqrt(8), rel=1e-12)
    assert hmax.limits("implicit_euler").real == math.inf


@pytest.mark.parametrize("n", [1, 2, 7, 60])
@pytest.mark.parametrize("form", [np.asarray, np.asfortranarray, sparse.csr_matrix, sparse.csc_matrix, sparse.coo_matrix])
def test_rk4_on_a_chain_of_springs_is_stable_up_to_its_closed_form(n, form):
    K, m, omega = spring_chain(n)
    limit = hmax.largest_stable_step("rk4", K=form(K), M=m)
    assert limit.h_max == pytest.approx(math.sqrt(8) / omega[-1], rel=1e-9)
    assert limit.bound == "stability"
    assert limit.omega == pytest.approx(omega[-1], rel=1e-9)
    assert limit.zeta == 0
    assert limit.mode == pytest.approx(1j * omega[-1], rel=1e-9)


def test_explicit_euler_on_a_damped_oscillator_is_stable_up_to_c_over_k():
    # Underdamped: h < c / k; overdamped: h < 4 m / (c + sqrt(c^2 - 4 k m)).
    assert hmax.largest_stable_step("explicit_euler", [[0.7]], [1.45], [[2.0]]).h_max == pytest.approx(2 / 0.7, rel=1e-9)
    over = 4 * 1.45 / (10 + math.sqrt(100 - 4 * 0.7 * 1.45))
    limit = hmax.largest_stable_step("explicit_euler", [[0.7]], [1.45], [[10.0]])
    assert limit.h_max == pytest.approx(over, rel=1e-9)
    assert limit.zeta == pytest.approx(10 / (2 * math.sqrt(0.7 * 1.45)), rel=1e-9)


def test_a_method_without_a_limit_has_an_infinite_step():
    K, m, _ = spring_chain(3)
    limit = hmax.largest_stable_step("newmark", K, m)
    assert limit.h_max == math.inf and limit.bound == "accuracy"
    assert hmax.largest_stable_step("explicit_euler", K, m).h_max == 0


def test_a_mass_that_couples_unknowns_has_the_limit_of_the_generalised_eigenvalues():
    K, m, _ = spring_chain(12)
    M = np.diag(4 * m) + np.diag(m[1:], 1) + np.diag(m[1:], -1)
    fastest = math.sqrt(linalg.eigh(K, M, eigvals_only=True)[-1])
    for form in (np.asarray, sparse.csr_matrix):
        assert hmax.largest_stable_step("rk4", form(K), form(M)).h_max == pytest.approx(math.sqrt(8) / fastest, rel=1e-9)


def test_the_limit_of_a_jacobian_is_that_of_its_eigenvalues():
    J = np.array([[-3.0, 1.0, 0.0], [0.0, -40.0, 5.0], [0.0, 0.0, -7.0]])
    for form in (np.asarray, sparse.csc_matrix):
        limit = hmax.largest_stable_step("explicit_euler", J=form(J))
        assert limit.h_max == pytest.approx(2 / 40, rel=1e-9)
        assert limit.mode == pytest.approx(-40, rel=1e-9)
    turning = np.array([[-1.0, 30.0], [-30.0, -1.0]])
    # |1 + h lambda| = 1 at h = -2 Re(lambda) / |lambda|^2.
    assert hmax.largest_stable_step("explicit_euler", J=turning).h_max == pytest.approx(2 / 901, rel=1e-9)


def test_runs_show_the_limit_that_is_predicted():
    K, m, _ = spring_chain(5)
    limit = hmax.largest_stable_step("symplectic_euler", K, m, verify=True)
    assert limit.observed == pytest.approx(limit.h_max, rel=1e-3)
    assert hmax.largest_stable_step("symplectic_euler", K, m).observed is None
    of_jacobian = hmax.largest_stable_step("explicit_euler", J=np.diag([-1.0, -5.0]), verify=True)
    assert of_jacobian.observed == pytest.approx(0.4, rel=1e-3)


@pytest.mark.parametrize("fastest", [False, True])
@pytest.mark.parametrize("coupled", [False, True])
@pytest.mark.parametrize("form", [np.asarray, sparse.csr_matrix])
def test_modes_solve_the_generalised_eigenvalue_problem(form, coupled, fastest):
    K, m, _ = spring_chain(20)
    M = np.diag(m) + (0.2 * (np.diag(m[1:], 1) + np.diag(m[1:], -1)) if coupled else 0)
    C = 0.3 * M + 1e-4 * K
    found = hmax.modes(form(K), form(M), form(C), count=4, fastest=fastest)
    kappa = linalg.eigh(K, M, eigvals_only=True)
    expected = np.sqrt(kappa[::-1][:4] if fastest else kappa[:4])
    np.testing.assert_allclose(found.omega, expected, rtol=1e-8)
    np.testing.assert_allclose(found.zeta, 0.3 / (2 * expected) + 1e-4 * expected / 2, rtol=1e-6)
    np.testing.assert_allclose(found.frequency, expected / (2 * np.pi), rtol=1e-8)
    np.testing.assert_allclose(found.shapes.T @ M @ found.shapes, np.eye(4), atol=1e-8)
    residual = K @ found.shapes - M @ found.shapes * found.omega**2
    assert np.abs(residual).max() <= 1e-7 * kappa[-1] * m[0] * np.abs(found.shapes).max()


def test_modes_that_grow_are_told_from_those_of_rigid_motion():
    found = hmax.modes(np.diag([-100.0, 0.0, 100.0]), np.ones(3), count=3)
    np.testing.assert_allclose(np.sort(found.kappa), [-100, 0, 100], atol=1e-9)
    np.testing.assert_allclose(found.omega, np.sqrt(np.maximum(found.kappa, 0)))


def test_more_modes_than_unknowns_are_all_of_them():
    K, m, omega = spring_chain(3)
    np.testing.assert_allclose(hmax.modes(K, m, count=100).omega, omega, rtol=1e-9)


def test_a_large_sparse_structure_takes_seconds():
    n = 20000
    K = sparse.diags([np.full(n, 200.0), np.full(n - 1, -100.0), np.full(n - 1, -100.0)], [0, 1, -1])
    limit = hmax.largest_stable_step("rk4", K, np.full(n, 0.01))
    assert limit.h_max == pytest.approx(math.sqrt(8) / 200, rel=1e-6)

"""What steps show, against closed forms and the program."""

import json

import hmax
import numpy as np
import pytest


def half_corrected(y, h):
    """x'' = 10 - 100 x by implicit Euler, half of whose correction is made: at rest x = 10 (2 / 100 + h^2).

    With a = 100 h^2 / (1 + 100 h^2) and b = 1 - a / 2 the multipliers are b +- i sqrt(b (1 - b)).
    """
    aim = y[0] + h * y[1] + 10 * h * h
    x = aim * (1 - 50 * h * h / (1 + 100 * h * h))
    return [x, (x - y[0]) / h]


def rate(h):
    b = 1 - 50 * h * h / (1 + 100 * h * h)
    return np.log(b + 1j * np.sqrt(b * (1 - b))) / h


def test_a_step_function_shows_its_closed_form():
    found = hmax.fidelity(half_corrected, y0=[0, 0], h=0.1, h0=1e-3, load=[1, 0])
    assert found.settles is True and found.grows is False and found.status is None
    assert found.settled_moves == pytest.approx(0.3 / 0.20001 - 1, rel=1e-4)
    assert found.stiffness_shown == pytest.approx(0.20001 / 0.3, rel=1e-4)
    mode = found.modes[0]
    assert mode.omega == pytest.approx(abs(rate(1e-3)), rel=1e-4)
    assert mode.omega_shown == pytest.approx(abs(rate(0.1)), rel=1e-4)
    assert mode.zeta_shown == pytest.approx(-rate(0.1).real / abs(rate(0.1)), rel=1e-4)
    assert hmax.fidelity(half_corrected, y0=[0, 0], h=0.1).h0 == pytest.approx(1e-3)
    assert hmax.fidelity(half_corrected, y0=[0, 0], h=0.1).stiffness_shown is None


def test_steps_that_grow_say_so():
    def symplectic_euler(y, h):  # stable up to 2 / 10
        v = y[1] + h * (10 - 100 * y[0])
        return [y[0] + h * v, v]

    found = hmax.fidelity(symplectic_euler, y0=[0, 0], h=0.25, h0=1e-3, load=[1, 0])
    assert found.settles is False and found.grows is True and found.stiffness_shown is None
    assert "a motion that changes sign in every step grows" in found.status


def test_a_body_has_the_rows_of_the_program(program):
    body = hmax.Body("cube:n=2", "fem_cauchy", load="press")
    found = hmax.fidelity(body, rate=100, methods=["vbd:iterations=3", "implicit_euler"], enter=9000)
    told = json.loads(
        program(
            *("fidelity --mesh cube:n=2 --model fem_cauchy --load press --rate 100 --method vbd:iterations=3").split(),
            *("--method implicit_euler --enter 9000 --json").split(),
        ).stdout
    )
    assert list(found) == list(told) and len(found.rows) == 2
    for mine, theirs in zip(found.rows, told["rows"]):
        assert list(mine) == list(theirs)
        assert mine.stiffness_shown == pytest.approx(theirs["stiffness_shown"], rel=1e-6)
        assert mine.modulus_to_enter == pytest.approx(theirs["modulus_to_enter"], rel=1e-4)
    assert len(hmax.fidelity(body, rate=100).rows) >= 4


def test_a_problem_by_id_shows_its_closed_form():
    # x = 1 at rest, where k1 + 3 k3 x^2 = 3.5; implicit Euler makes 1 / (1 - lambda h) of a mode.
    row = hmax.fidelity(
        "liver_forced", rate=10, methods="implicit_euler", y0=[0, 0], m=1.4, c=0.7, k1=1.25, k3=0.75, P=2, w=0
    ).rows[0]
    omega, zeta = np.sqrt(2.5), 0.7 / (2 * 1.4 * np.sqrt(2.5))
    shown = -np.log(1 - 0.1 * omega * (-zeta + 1j * np.sqrt(1 - zeta**2))) / 0.1
    assert row.stiffness_shown == pytest.approx(1, rel=1e-9)
    assert row.modes[0].omega == pytest.approx(omega) and row.modes[0].zeta == pytest.approx(zeta)
    assert row.modes[0].omega_shown == pytest.approx(abs(shown), rel=1e-4)
    assert row.modes[0].zeta_shown == pytest.approx(-shown.real / abs(shown), rel=1e-4)
    assert row.volume_kept is None


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: hmax.fidelity(half_corrected, h=0.1), "y0 is missing"),
        (lambda: hmax.fidelity(half_corrected, y0=[0, 0]), "h is missing"),
        (lambda: hmax.fidelity(half_corrected, y0=[0, 0], h=0.1, h0=1), "smaller one first"),
        (lambda: hmax.fidelity(half_corrected, y0=[0, 0], h=0.1, load=[1]), "load must be 2 numbers"),
        (lambda: hmax.fidelity(half_corrected, rate=100), "rate does not belong to a step function"),
        (lambda: hmax.fidelity(lambda y, h: y, y0=np.zeros(301), h=0.1), "takes up to 300"),
        (lambda: hmax.fidelity(3, y0=[0], h=0.1), "step is 3 but must be a function"),
        (lambda: hmax.fidelity(hmax.Body("cube:n=2", g=0), rate=100), "nothing loads the body"),
        (lambda: hmax.fidelity(hmax.Body("cube:n=2", load="press")), "rate is None"),
        (lambda: hmax.fidelity(hmax.Body("cube:n=2", load="press"), rate=100, enter=0), "enter is 0"),
        (lambda: hmax.fidelity(hmax.Body("cube:n=2", load="press"), rate=100, h=1), "h does not belong to a Body"),
        (lambda: hmax.fidelity(hmax.Body("cube:n=2", load="press"), rate=100, methods=["vbd:iteration=3"]), "iterations"),
        (lambda: hmax.fidelity(hmax.Body("cube:n=2", load="breathing"), rate=100), "never settles"),
        (lambda: hmax.fidelity(hmax.Body("cube:n=2", load="press"), rate=100, E=5e3), "E does not belong to a Body"),
        (lambda: hmax.fidelity("liver_linear", rate=10, h=1), "h does not belong to a problem by id"),
        (lambda: hmax.fidelity("robertson", rate=10), "no positions and velocities"),
        (lambda: hmax.fidelity("liver_linear", rate=10, ceiling=True), "has no modulus"),
    ],
)
def test_wrong_input_is_told(call, words):
    with pytest.raises(ValueError, match=words):
        call()

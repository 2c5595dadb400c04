"""Integration."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Optional

from . import _core
from ._arguments import Matrix, function, matrix, number, structure, vector
from ._stability import method_name


@dataclass(frozen=True, eq=False)
class Run:
    """The points of an integration."""

    outcome: str
    """"reached_end", or why the run ended before, such as "diverged" or "step_too_small"."""
    t: Any
    """Instants [s], shape (points)."""
    y: Any
    """States, one a row, shape (points, n)."""
    stats: Dict[str, int]
    """Counts: steps, rejected, rhs, jacobian, factorisations, newton."""
    status: str
    """What else is to be said; often empty."""


def integrate(
    method: str,
    rhs: Optional[Callable[[float, Any], Any]] = None,
    y0: Any = None,
    t_end: Optional[float] = None,
    h: Optional[float] = None,
    rtol: Optional[float] = None,
    atol: Optional[float] = None,
    jacobian: Optional[Callable[[float, Any], Matrix]] = None,
    K: Optional[Matrix] = None,
    M: Optional[Matrix] = None,
    C: Optional[Matrix] = None,
    every: Optional[float] = None,
) -> Run:
    """Integrates y' = rhs(t, y), or M q'' + C q' + K q = 0, from t = 0.

    Parameters
    ----------
    method : a name of methods(), with parameters such as "newmark:beta=0.25,gamma=0.5"
    rhs : function of t [s] and y, shape (n), that returns y', shape (n)
    y0 : state at t = 0, shape (n); of K and M the displacements, then the velocities, shape (2 n)
    t_end : end of the run [s]
    h : fixed step size [s]; without it steps are adaptive
    rtol, atol : tolerances of adaptive steps; atol is rtol by default
    jacobian : function of t and y that returns d rhs / d y, shape (n, n), dense or of scipy.sparse; by default implicit methods
        take differences
    K, M, C : as of largest_stable_step(), instead of rhs
    every : interval of the points that are kept [s]; every step by default

    Exceptions of rhs and jacobian end the run and are raised as they are. Raises ValueError for other input that is wrong.

    >>> import hmax
    >>> import numpy as np
    >>> run = hmax.integrate("rk4", lambda t, y: [y[1], -y[0]], y0=[1, 0], t_end=2, h=0.01)
    >>> print(run.outcome, run.stats["steps"], abs(run.y[-1, 0] - np.cos(2)) < 1e-9)
    reached_end 200 True
    """
    if y0 is None:
        raise ValueError("y0 is missing; give the state at the start")
    settings = run_settings(t_end, h, rtol, atol, every)
    start = vector("y0", y0)
    if rhs is not None:
        if K is not None or M is not None or C is not None:
            raise ValueError("rhs and matrices are both given; give one of them")
        return Run(**_core.run_function(method_name(method), function("rhs", rhs), _as_matrices(function("jacobian", jacobian)), start, *settings))
    if jacobian is not None:
        raise ValueError("jacobian is of rhs, and matrices are given; leave it out")
    return Run(**_core.run_structure(method_name(method), *structure(K, M, C, "rhs"), start, *settings))


def run_settings(t_end: Any, h: Any, rtol: Any, atol: Any, every: Any) -> List[Optional[float]]:
    """The numbers that a run needs, atol that of rtol where none is given."""
    if t_end is None:
        raise ValueError("t_end is missing; give the end of the run in seconds")
    if (h is None) == (rtol is None):
        raise ValueError("give either h, a fixed step size, or rtol, a tolerance of adaptive steps")
    if h is not None and atol is not None:
        raise ValueError("atol is of adaptive steps, and h is given; leave one of them out")
    given = (("t_end", t_end), ("h", h), ("rtol", rtol), ("atol", rtol if atol is None else atol), ("every", every))
    return [number(name, value) for name, value in given]


def _as_matrices(jacobian: Optional[Callable[[float, Any], Matrix]]) -> Optional[Callable[[float, Any], Any]]:
    if jacobian is None:
        return None
    own = jacobian

    def at(t: float, y: Any) -> Any:
        return matrix("the Jacobian", own(t, y))

    return at

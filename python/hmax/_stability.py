"""Methods, their stability, and the largest stable step of matrices."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, List, Optional

import numpy as np
import scipy.sparse as sparse

from . import _core
from ._answer import Answer, answer, answers
from ._arguments import Matrix, count as whole, matrix, structure


def methods() -> List[Answer]:
    """The methods of the catalogue, as `hmax list methods --json`.

    Each has `id`, `aliases`, `family`, `order`, `error_order`, `stages`, `explicit`, `adaptive`, `needs_jacobian`,
    `a_stable`, `l_stable`, `engine`, `source` and more.

    >>> import hmax
    >>> [method.id for method in hmax.methods() if method.family == "rosenbrock" and method.order == 2]
    ['rosenbrock_23']
    """
    return answers(_core.methods())


def limits(method: str) -> Answer:
    """The stability of a method in numbers, as `hmax stability limits --json`.

    `real` and `imaginary` are the stable intervals of the axes of z = h lambda: a decay of rate r is stable up to
    h = real / r, an undamped oscillation up to h = imaginary / omega.

    Parameters
    ----------
    method : a name of methods(), an alias such as "ode45", or a formula such as "bdf_3"

    Raises ValueError for an unknown name, with the nearest one.

    >>> import hmax
    >>> rk4 = hmax.limits("rk4")
    >>> print(f"{rk4.real:.6f} {rk4.imaginary:.6f} {rk4.a_stable}")
    2.785294 2.828427 False
    """
    return answer(_core.limits(method_name(method)))


def region(method: str, cells: int = 400) -> Answer:
    """The boundary of the stability region in the plane of z = h lambda, as `hmax stability region --json`.

    `curves` are closed, each an array of shape (points, 2) of real and imaginary parts; `about` says of each its `area`, whether
    it is a `hole`, and whether it is `clipped` by the `window` [re_from, re_to, im_from, im_to].

    Parameters
    ----------
    method : as of limits()
    cells : of the grid along the longer side of the window, 2 to 4000

    >>> import hmax
    >>> region = hmax.region("explicit_euler")  # the disc |1 + z| <= 1
    >>> print(f"{region.about[0].area:.3f}")
    3.142
    """
    if whole("cells", cells, 2) > 4000:
        raise ValueError(f"cells is {cells}; give 4000 at most")
    found = answer(_core.region(method_name(method), int(cells)))
    found["curves"] = [np.asarray(curve) for curve in found.curves]
    return found


@dataclass(frozen=True)
class Limit:
    """The largest stable step of a method."""

    h_max: float
    """[s]; inf: no step is unstable; 0: every step is unstable; nan: there is no limit, as `bound` and `status` say."""
    bound: str
    """"stability", "accuracy" or "newton" (no step is unstable), "every_step", "model" (every mode grows),
    "error_control" or "unknown"."""
    omega: Optional[float]
    """Natural frequency of the mode that sets the limit [rad/s]; None where it has none."""
    zeta: Optional[float]
    """Its damping ratio; None where it has none."""
    mode: Optional[complex]
    """Its eigenvalue [1/s]; None where no mode sets the limit."""
    status: str
    """What else is to be said; often empty."""
    method: str
    """Its name in the catalogue."""
    observed: Optional[float] = None
    """The limit that runs show [s], with verify=True; None where none was shown."""


def largest_stable_step(
    method: str,
    K: Optional[Matrix] = None,
    M: Optional[Matrix] = None,
    C: Optional[Matrix] = None,
    J: Optional[Matrix] = None,
    verify: bool = False,
) -> Limit:
    """The largest stable step of a method for M q'' + C q' + K q = 0, or for y' = J y.

    Parameters
    ----------
    method : a name of methods(), with parameters such as "newmark:beta=0.25,gamma=0.5"
    K, M, C : stiffness [N/m], mass [kg] and damping [N s/m], shape (n, n), dense or of scipy.sparse; M may be a vector of n masses
    J : Jacobian of a first-order model, shape (n, n) [1/s]
    verify : also integrate on both sides of the limit, with the code of the method; `observed` is what it shows

    Raises ValueError for an unknown method, shapes that do not agree, entries that are not finite, and masses that are not
    positive.

    >>> import hmax
    >>> limit = hmax.largest_stable_step("rk4", K=[[200, -100], [-100, 100]], M=[0.01, 0.01])
    >>> print(f"{limit.h_max:.6f} s, limited by {limit.bound} of omega = {limit.omega:.2f} rad/s")
    0.017481 s, limited by stability of omega = 161.80 rad/s
    """
    if J is None:
        return Limit(**_core.limit_of_structure(method_name(method), *structure(K, M, C, "the Jacobian J of y' = J y"), bool(verify)))
    if any(given is not None for given in (K, M, C)):
        raise ValueError("J is of a first-order model and K, M and C are of one of second order; give one of them")
    return Limit(**_core.limit_of_jacobian(method_name(method), sparse.csc_matrix(matrix("J", J)), bool(verify)))


@dataclass(frozen=True, eq=False)
class Modes:
    """Modes of free motion."""

    omega: Any
    """Natural frequencies [rad/s], shape (count); 0 of modes that do not oscillate, see kappa."""
    zeta: Any
    """Damping ratios of the diagonal of the damping in these modes, shape (count)."""
    shapes: Any
    """Shapes u, one a column, with u^T M u = 1, shape (n, count)."""
    kappa: Any
    """u^T K u [1/s^2], shape (count): omega^2; negative of modes that grow. The slowest modes are those nearest to zero."""

    @property
    def frequency(self) -> Any:
        """[Hz]"""
        return self.omega / (2 * np.pi)


def modes(K: Matrix, M: Matrix, C: Optional[Matrix] = None, count: int = 6, fastest: bool = False) -> Modes:
    """The slowest or the fastest modes of M q'' + C q' + K q = 0, with symmetric K and C.

    Parameters
    ----------
    K, M, C : as of largest_stable_step()
    count : of modes; no more than n are found
    fastest : the fastest ones, which limit the step size, instead of the slowest

    Raises ValueError as largest_stable_step(), and for matrices that are not symmetric.

    >>> import hmax
    >>> modes = hmax.modes([[200, -100], [-100, 100]], [0.01, 0.01])
    >>> print(modes.omega.round(2))
    [ 61.8 161.8]
    """
    return Modes(*_core.modes(*structure(K, M, C), whole("count", count), bool(fastest)))


def method_name(method: Any) -> str:
    """The name, which must be text."""
    if not isinstance(method, str):
        raise ValueError(f"the method is {method!r} but must be a name of hmax.methods(), such as 'rk4'")
    return method

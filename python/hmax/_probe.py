"""The largest stable step of a step function of one's own."""

from __future__ import annotations

from typing import Any, Callable, Optional, Sequence

import numpy as np
import scipy.sparse as sparse

from . import _core
from ._answer import Answer, answer
from ._arguments import Matrix, count, finite, function, matrix, number, vector


def probe(
    step: Callable[[Any, float], Any],
    y0: Any,
    h0: float,
    h1: float,
    save: Optional[Callable[[], Any]] = None,
    restore: Optional[Callable[[Any], None]] = None,
    motion: Optional[float] = None,
    verify: bool = True,
    quaternions: Sequence[int] = (),
    scales: Any = None,
    pattern: Optional[Matrix] = None,
    name: str = "step",
    own_step: Optional[float] = None,
) -> Answer:
    """The largest stable step of a step function or an engine, from the Jacobian of its step and from running it.

    `step(y, h)` advances the state y, shape (n), by h [s]. Either it returns the next state. What the engine keeps beside y, if
    anything, is then what `save` returns and `restore` takes, objects of any kind. Or it advances an engine in place and returns
    None. The state is then what `save` returns and `restore` takes, an array of shape (n) that holds everything the next step
    depends on, and y0 may be None.

    Parameters
    ----------
    step : as above
    y0 : the state to look at, shape (n), best an equilibrium; None: the state that the engine has now
    h0, h1 : the smallest and the largest step size to look at [s]
    save, restore : as above
    motion : follow the motion of this length [s] instead of the one state
    verify : also run the engine on both sides of the limit, some ten runs of up to 2 s
    quaternions : first index of each four numbers of the state that are a unit quaternion
    scales : sizes of noticeable changes of the state, shape (n)
    pattern : shape (n, n), an entry (i, j) other than zero where number i after a step depends on number j before it; of many numbers
        it saves steps
    name : of the engine, for `model`
    own_step : the step size that the engine takes [s], of which the answer tells more

    A state of numpy.float32 says that steps are computed in single precision.

    Returns the keys of `hmax probe --json`: `h_max` and `observed` [s] (inf: no growth up to h1; None: not found), `gap`, `state`
    ("equilibrium", "initial" or "motion"), `smoothness` of the step there ("smooth", "kink" or "jump"), `rows` by h (each with `settles`, `settled_moves` and `modes`), `moving`, `dim`, `steps`, `status`, `contradiction` (h_max and observed cannot
    both be right; `status` says why). Of `own_step` also: `timestep`, the same; `stable`; `substeps`, the smallest number of equal parts
    that are stable; `settles`; `stiffness_shown` of the slowest mode.

    Exceptions of step, save and restore are raised as they are. Raises ValueError for other input that is wrong.

    >>> import hmax
    >>> import numpy as np
    >>> def symplectic_euler(y, h):  # x'' = -100 x: stable up to h = 2 / 10
    ...     v = y[1] - h * 100 * y[0]
    ...     return np.array([y[0] + h * v, v])
    >>> found = hmax.probe(symplectic_euler, [0, 0], h0=0.01, h1=1)
    >>> print(f"{found.h_max:.3f} s, runs show {found.observed:.3f} s")
    0.200 s, runs show 0.200 s
    """
    _check_functions(step, save, restore)
    if (save is None) != (restore is None):
        raise ValueError("save and restore belong together; give both, or none of them")
    if y0 is None and save is None:
        raise ValueError("y0 is missing; give the state, or save and restore of an engine that keeps it")
    if number("h0", h0) is None or number("h1", h1) is None:
        raise ValueError("give the step sizes to look at, such as h0=1e-4 and h1=0.1")
    own = number("own_step", own_step)
    if own is not None and not own > 0:
        raise ValueError(f"own_step must be positive, not {own_step}; give the step size of the engine in seconds")
    start = save() if y0 is None and save else y0
    y = _start("y0" if y0 is not None else "what save returns", start)
    in_place = y0 is None or _steps_in_place(step, y, float(h0), save, restore)
    if in_place and y0 is not None and restore:
        restore(y.copy())
    extent = np.empty(0) if scales is None else vector("scales", scales)
    if scales is not None and (extent.shape != y.shape or not (np.isfinite(extent) & (extent > 0)).all()):
        raise ValueError(f"scales must be {len(y)} positive numbers, one for each of the state")
    indices = [count("an index of quaternions", index, 0) for index in np.ravel(quaternions)]
    single = np.asarray(start).dtype == np.float32
    engine = (step, save, restore, y, in_place, str(name), single, indices, extent, _pattern(pattern, len(y)))
    return answer(_core.probe(*engine, float(h0), float(h1), number("motion", motion), bool(verify), own))


def steps_fidelity(step: Any, y0: Any, h: Any, h0: Any, load: Any) -> Answer:
    """hmax.fidelity of a step function."""
    _check_functions(step)
    if y0 is None:
        raise ValueError("y0 is missing; give the state that steps begin with")
    size = number("h", h)
    if size is None:
        raise ValueError("h is missing; give the step size to look at, such as h=0.01")
    smallest = size / 100 if h0 is None else float(number("h0", h0) or 0)
    y = _start("y0", y0)
    _steps_in_place(step, y, smallest, None, None)
    force = np.empty(0) if load is None else vector("load", load)
    if load is not None and (force.shape != y.shape or not force.any()):
        raise ValueError(f"load must be {len(y)} numbers, one for each of the state, not all zero")
    single = np.asarray(y0).dtype == np.float32
    return answer(_core.compare(step, y, "step", single, smallest, size, force))


def _check_functions(step: Any, save: Any = None, restore: Any = None) -> None:
    for what, given in (("step", step), ("save", save), ("restore", restore)):
        function(what, given)
    if step is None:
        raise ValueError("step is missing; give a function of the state and the step size")


def _start(name: str, given: Any) -> Any:
    y = vector(name, given)
    if len(y) == 0:
        raise ValueError("the state has no numbers; give at least one")
    return y


def _pattern(given: Optional[Matrix], size: int) -> Any:
    if given is None:
        return sparse.csc_matrix((0, 0))
    entries = sparse.csc_matrix(matrix("pattern", given))
    if entries.shape != (size, size):
        raise ValueError(f"pattern has the shape {entries.shape[0]} x {entries.shape[1]} but must have {size} x {size}")
    finite("pattern", entries.data)
    entries.eliminate_zeros()
    return entries


def _steps_in_place(step: Any, y: Any, h: float, save: Any, restore: Any) -> bool:
    """Whether step returns None; the engine is left as it was."""
    if save is None:
        if step(y.copy(), h) is None:
            raise ValueError("step returned None; return the next state, or give save and restore of its engine")
        return False
    before = save()
    in_place = step(y.copy(), h) is None
    restore(before)
    return in_place

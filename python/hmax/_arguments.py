"""What users give, as the extension module takes it."""

from __future__ import annotations

from typing import Any, Optional, Tuple

import numpy as np
import scipy.sparse as sparse

Matrix = Any  #: a dense array, or a sparse matrix of scipy


def matrix(name: str, given: Matrix) -> Any:
    """A dense float array, or a sparse float matrix by columns; what is both already is not copied.

    Shapes and entries are checked where the matrix is used.

    Raises ValueError for what holds no real numbers, and for damaged sparse matrices.
    """
    if sparse.issparse(given):
        _require_real(name, given.dtype)
        rows, width = given.shape
        if rows != width:  # before memory is taken for a pointer to each column
            raise ValueError(f"{name} has the shape {rows} x {width} but must be square")
        try:
            _check_format(given)  # converting what is damaged reads beyond its arrays
            columns = sparse.csc_matrix(given, dtype=float)
            columns.check_format(full_check=True)
        except (ValueError, TypeError) as error:
            raise ValueError(f"{name} is a damaged sparse matrix ({error}); make it again") from None
        if not columns.has_canonical_format:
            columns = columns.copy()
            columns.sum_duplicates()
        return columns
    dense = _array(name, given)
    if dense.ndim != 2:
        raise ValueError(f"{name} has {dense.ndim} dimensions but must have two; give a square matrix")
    return np.asarray(dense, dtype=float)


def _check_format(given: Any) -> None:
    """Raises ValueError where the indices of a sparse matrix point beyond its arrays."""
    if sparse.isspmatrix_coo(given):
        sparse.coo_matrix((given.data, (given.row, given.col)), shape=given.shape)
    elif hasattr(given, "check_format"):
        given.check_format(full_check=True)


def masses(given: Matrix) -> Any:
    """The same of a mass: a matrix, or a vector of one mass for each degree of freedom."""
    if sparse.issparse(given) or np.ndim(given) != 1:
        return matrix("M", given)
    return np.asarray(_array("M", given), dtype=float)


def vector(name: str, given: Any) -> Any:
    """A float array of one dimension, of finite numbers."""
    numbers = _array(name, given)
    if numbers.ndim != 1:
        raise ValueError(f"{name} has {numbers.ndim} dimensions but must have one; give one number for each unknown")
    floats = np.asarray(numbers, dtype=float)
    finite(name, floats)
    return floats


def finite(name: str, values: Any) -> None:
    """Raises ValueError for the first number of an array of one dimension that is not finite."""
    bad = np.flatnonzero(~np.isfinite(values))
    if len(bad):
        raise ValueError(f"{name}[{bad[0]}] is {values[bad[0]]}; every number must be finite")


def structure(K: Optional[Matrix], M: Optional[Matrix], C: Optional[Matrix], otherwise: str = "") -> Tuple[Any, Any, Any]:
    """K, M and C of M q'' + C q' + K q = 0; `otherwise` is what may be given instead."""
    if K is None or M is None:
        missing = "K" if K is None else "M"
        raise ValueError(f"{missing} is missing; give the stiffness K and the mass M{otherwise and ', or ' + otherwise}")
    return matrix("K", K), masses(M), None if C is None else matrix("C", C)


def count(name: str, given: Any, least: int = 1) -> int:
    """A whole number of at least `least`."""
    if isinstance(given, (int, float, np.number)) and given >= least and given == np.floor(given) and np.isfinite(float(given)):
        return min(int(given), 2**62)
    raise ValueError(f"{name} is {given!r} but must be a whole number of at least {least}")


def function(name: str, given: Any) -> Any:
    """What can be called; None stays."""
    if given is None or callable(given):
        return given
    raise ValueError(f"{name} is {given!r} but must be a function")


def number(name: str, given: Any) -> Optional[float]:
    """A float; None stays."""
    if given is None:
        return None
    try:
        return float(given)
    except (TypeError, ValueError):
        raise ValueError(f"{name} is {given!r} but must be a number") from None


def instant(given: Any) -> float:
    """A time t [s] at which a model is evaluated."""
    t = number("t", given)
    if t is None or not np.isfinite(t):
        raise ValueError(f"t is {given} but must be a finite number of seconds")
    return t


def _array(name: str, given: Any) -> Any:
    # numpy would hand over what stands below the mask
    if np.ma.is_masked(given) or isinstance(given, (list, tuple)) and any(map(np.ma.is_masked, given)):
        raise ValueError(f"{name} has masked entries; give every number, such as with its method filled()")
    try:
        array = np.asarray(given)
    except ValueError:  # rows of different lengths
        raise ValueError(f"{name} is no array of numbers; give rows of one length") from None
    _require_real(name, array.dtype)
    return array


def _require_real(name: str, dtype: Any) -> None:
    if dtype.kind == "c":
        raise ValueError(f"{name} is complex but must be real; give its real part, if it is the model's")
    if dtype.kind not in "biuf":
        raise ValueError(f"{name} holds {dtype} and no real numbers; give an array of floats")

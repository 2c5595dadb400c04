"""Masses that couple degrees of freedom."""

from __future__ import annotations

from typing import Any, Callable, NamedTuple

import numpy as np
import scipy.linalg as linalg
import scipy.sparse as sparse

MOST_COUPLED = 4000  #: rows of a mass matrix that is factored here


class Structure(NamedTuple):
    """M q'' + C q' + K q = 0 in unknowns x = L^T q, and the way between them."""

    K: Any
    M: Any
    C: Any
    to_unknowns: Callable[[Any], Any]  #: x of q, shape (n) or (n, k)
    from_unknowns: Callable[[Any], Any]  #: q of x


def with_lumped_masses(K: Any, M: Any, C: Any) -> Structure:
    """The same motion with lumped masses: as it is, or, for a mass that couples degrees of freedom, M = L L^T, with unit masses.

    L^-1 K L^-T x + ... = 0 has the eigenvalues of M^-1 K. Matrices that make no structure are left as they are: the
    extension module says what is wrong with them.
    """
    unchanged = Structure(K, M, C, lambda q: q, lambda x: x)
    if sparse.issparse(K) and sparse.issparse(M) and (C is None or sparse.issparse(C)):
        return unchanged  # the extension module takes sparse masses that couple, at any size
    if M.ndim != 2 or M.shape[0] != M.shape[1] or M.shape[0] > MOST_COUPLED or M.shape != K.shape:
        return unchanged
    dense = _dense(M)
    if not np.isfinite(dense).all() or not np.any(dense - np.diag(dense.diagonal())):
        return unchanged
    if not np.allclose(dense, dense.T, rtol=1e-10, atol=1e-10 * np.abs(dense).max()):
        return unchanged
    try:
        L = linalg.cholesky(dense, lower=True)
    except linalg.LinAlgError:
        return unchanged

    def scaled(A: Any) -> Any:
        half = linalg.solve_triangular(L, _dense(A), lower=True)
        whole = linalg.solve_triangular(L, half.T, lower=True).T
        symmetric = (A != A.T).nnz == 0 if sparse.issparse(A) else np.array_equal(A, A.T)
        return (whole + whole.T) / 2 if symmetric else whole

    if not all(A is None or (A.shape == K.shape and np.isfinite(_dense(A)).all()) for A in (K, C)):
        return unchanged
    return Structure(
        scaled(K),
        np.ones(len(L)),
        None if C is None else scaled(C),
        lambda q: L.T @ q,
        lambda x: linalg.solve_triangular(L.T, x, lower=False),
    )


def _dense(A: Any) -> Any:
    return A.toarray() if sparse.issparse(A) else A

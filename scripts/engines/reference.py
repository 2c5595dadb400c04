"""Step limits and frequencies of a set of matrices from SciPy: readers and analysis that share nothing with hmax."""
import numpy
import scipy.io
import scipy.linalg
import scipy.sparse
import scipy.sparse.linalg

MOST_DENSE = 2500  # unknowns whose eigenvalues are all computed
MOST_DAMPED = 500  # the same where damping doubles them


def petsc(file):
    """A matrix, or a vector as a column, with indices of 32 bits."""
    data = file.read_bytes()
    head = numpy.frombuffer(data, ">i4", 4)
    if head[0] == 1211214:
        return numpy.frombuffer(data, ">f8", head[1], 8).astype(float)[:, None]
    rows, columns, entries = (int(x) for x in head[1:])
    lengths = numpy.frombuffer(data, ">i4", rows, 16)
    places = numpy.frombuffer(data, ">i4", entries, 16 + 4 * rows)
    values = numpy.frombuffer(data, ">f8", entries, 16 + 4 * (rows + entries))
    start = numpy.concatenate([[0], numpy.cumsum(lengths)])
    return scipy.sparse.csr_matrix((values.astype(float), places.astype(int), start), shape=(rows, columns))


def calculix(file):
    i, j, values = numpy.loadtxt(file, unpack=True)
    i, j, n = i.astype(int) - 1, j.astype(int) - 1, int(max(i.max(), j.max()))
    upper = scipy.sparse.csr_matrix((values, (i, j)), shape=(n, n))
    return upper + upper.T - scipy.sparse.diags(upper.diagonal())


def matrix(file):
    if file.suffix == ".mtx":
        return scipy.sparse.csr_matrix(scipy.io.mmread(file))
    return petsc(file) if file.suffix == ".petsc" else calculix(file)


def structure(folder, matrices):
    """K, M and C (None without) as sparse matrices without their massless rows and multipliers."""
    lumped = matrices["mass"].startswith("lumped:")
    K, M = matrix(folder / matrices["stiffness"]), matrix(folder / matrices["mass"].removeprefix("lumped:"))
    C = matrix(folder / matrices["damping"]) if "damping" in matrices else None
    if M.shape[1] == 1 or lumped:
        M = scipy.sparse.diags(numpy.asarray(M.sum(axis=1)).ravel()).tocsr()
    empty = M.diagonal() == 0
    if empty.any():
        u, m = numpy.flatnonzero(~empty), numpy.flatnonzero(empty)
        if abs(K[m][:, m]).sum() == 0:  # multipliers: the motions that G q = 0 leaves
            Z = scipy.linalg.null_space(K[m][:, u].toarray())
            return tuple(scipy.sparse.csr_matrix(Z.T @ A[u][:, u].toarray() @ Z) for A in (K, M)) + (None,)
        solved = scipy.sparse.linalg.splu(K[m][:, m].tocsc()).solve(K[m][:, u].toarray())
        K = scipy.sparse.csr_matrix(K[u][:, u] - K[u][:, m] @ solved)
        M, C = M[u][:, u], None if C is None else C[u][:, u]
    return K, M, C


def is_symmetric(A):
    return abs(A - A.T).max() <= 1e-10 * abs(A).max()


def first_unstable(radius, low, high):
    """The smallest h on a fine grid where radius(h) exceeds one by 1e-6, refined."""
    before = low
    for h in numpy.geomspace(low, high, 200):
        if radius(h) > 1 + 1e-6:
            for _ in range(40):
                middle = (before + h) / 2
                before, h = (before, middle) if radius(middle) > 1 + 1e-6 else (middle, h)
            return h
        before = h
    return None


def rk4_radius(rates):
    return lambda h: max(abs(1 + z + z * z / 2 + z ** 3 / 6 + z ** 4 / 24) for z in h * rates)


def of_kappa(kappa, beta):
    """Limits of rk4 and symplectic Euler, and the frequencies, where each mode has q'' + beta kappa q' + kappa q = 0."""
    rates = numpy.concatenate([numpy.roots([1, beta * k, k]) for k in kappa]) if kappa.size < 1e4 else None
    top = kappa.max()
    symplectic = (-beta * top + (beta * beta * top * top + 4 * top) ** 0.5) / top
    far = rates[abs(rates) > 1e-4 * abs(rates).max()]
    guess = 1 / abs(rates).max()
    return {"symplectic_euler": symplectic, "rk4": first_unstable(rk4_radius(far), 0.5 * guess, 4 * guess)}


def limits(folder, facts):
    """{"rk4": s, "symplectic_euler": s, "lowest": [rad/s]}, as far as they are computed; {} where they are not."""
    K, M, C = structure(folder, facts["matrices"])
    options = facts["options"]
    beta = float(options[options.index("--beta") + 1]) if "--beta" in options else 0.0
    n = K.shape[0]
    if C is not None:
        return damped(K, M, C) if n <= MOST_DAMPED else {}
    if n > MOST_DENSE:
        if not is_symmetric(K):
            return {}
        inverse = scipy.sparse.linalg.splu(M.tocsc())
        apply = scipy.sparse.linalg.LinearOperator((n, n), inverse.solve)
        return of_kappa(scipy.sparse.linalg.eigsh(K, 1, M, Minv=apply, tol=1e-9, ncv=60, return_eigenvectors=False), beta)
    if is_symmetric(K):
        try:
            kappa = scipy.linalg.eigh(K.toarray(), M.toarray(), eigvals_only=True)
        except numpy.linalg.LinAlgError:
            least = scipy.linalg.eigvalsh(M.toarray())
            return {"status": f"M is singular: {(least < 1e-12 * least[-1]).sum()} of its eigenvalues are zero"}
    else:
        kappa = scipy.linalg.eigvals(numpy.linalg.solve(M.toarray(), K.toarray()))
        if abs(kappa.imag).max() > 1e-8 * abs(kappa).max():
            return {"status": "K and M have complex eigenvalues"}
        kappa = numpy.sort(kappa.real)
    found = of_kappa(kappa, beta)
    found["lowest"] = list(numpy.sign(kappa[:10]) * abs(kappa[:10]) ** 0.5)
    return found


def damped(K, M, C):
    n = K.shape[0]
    I, Z = numpy.eye(n), numpy.zeros((n, n))
    k, c = (numpy.linalg.solve(M.toarray(), A.toarray()) for A in (K, C))
    rates = numpy.linalg.eigvals(numpy.block([[Z, I], [-k, -c]]))
    if rates.real.max() > 1e-7 * abs(rates).max():
        return {"status": f"the model grows by itself at {rates.real.max():.3g} 1/s"}
    def symplectic(h):
        return abs(numpy.linalg.eigvals(numpy.block([[I - h * h * k, h * (I - h * c)], [-h * k, I - h * c]]))).max()
    low, high = 0.5 / abs(rates).max(), 4 / abs(rates).max()
    while high - low > 1e-6 * high:
        middle = (low + high) / 2
        low, high = (low, middle) if symplectic(middle) > 1 + 1e-9 else (middle, high)
    return {"rk4": first_unstable(rk4_radius(rates), 0.5 / abs(rates).max(), 4 / abs(rates).max()), "symplectic_euler": low}

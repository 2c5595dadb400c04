"""Wrong input is a ValueError that says what to do, and never a crash."""

import hmax
import numpy as np
import pytest
import scipy.sparse as sparse
from conftest import spring_chain

GOOD = np.array([[200.0, -100.0], [-100.0, 100.0]])
MASSES = [0.01, 0.01]


def limit(**given):
    arguments = {"method": "rk4", "K": GOOD, "M": MASSES}
    arguments.update(given)
    return hmax.largest_stable_step(**arguments)


@pytest.mark.parametrize(
    "given, words",
    [
        ({"method": "rk44"}, "rk4"),
        ({"method": 4}, "must be a name"),
        ({"K": GOOD[:, :1]}, "shape 2 x 1 but must be square"),
        ({"K": sparse.csr_matrix((3, 10**9))}, "shape 3 x 1000000000 but must be square"),
        ({"K": np.ones((3, 3))}, "2 masses, but K has 3 rows"),
        ({"K": [[1.0, np.nan], [np.nan, 1.0]]}, "row 2, column 1"),
        ({"K": sparse.csr_matrix(np.array([[1.0, np.inf], [np.inf, 1.0]]))}, "inf"),
        ({"K": np.tril(GOOD)}, "both triangles"),
        ({"K": GOOD + 1j}, "complex"),
        ({"K": sparse.csr_matrix(GOOD + 1j)}, "complex"),
        ({"K": np.array([[object(), 1], [1, 2]])}, "no real numbers"),
        ({"K": [["a", "b"], ["c", "d"]]}, "no real numbers"),
        ({"K": [[1, 2], [3]]}, "K"),
        ({"K": 3.0}, "dimensions"),
        ({"K": np.ones((2, 2, 2))}, "3 dimensions"),
        ({"K": np.ones((0, 0)), "M": []}, "no rows"),
        ({"K": sparse.csc_matrix((0, 0)), "M": np.ones(0)}, "no rows"),
        ({"K": None}, "K and the mass M, or the Jacobian"),
        ({"M": None}, "M is missing"),
        ({"M": [0.01, 0.0]}, "mass of degree of freedom 2 is 0"),
        ({"M": [0.01, -1.0]}, "must be positive"),
        ({"M": [0.01, np.nan]}, "nan"),
        ({"M": [0.01]}, "1 masses"),
        ({"M": np.array([[1.0, 0.5], [0.0, 1.0]])}, "M"),
        ({"M": np.array([[1.0, 2.0], [2.0, 1.0]])}, "not positive definite"),
        ({"C": np.ones((3, 3))}, "C has the shape 3 x 3"),
        ({"C": "x"}, "no real numbers"),
        ({"J": GOOD}, "give one of them"),
        ({"K": None, "M": None, "J": np.ones((2, 3))}, "J has the shape 2 x 3"),
        ({"K": None, "M": None, "J": [[np.nan]]}, "every entry must be finite"),
        ({"K": None, "M": None, "J": np.ones((0, 0))}, "square"),
    ],
)
def test_wrong_matrices_are_told(given, words):
    with pytest.raises(ValueError, match=words):
        limit(**given)


def test_damaged_sparse_matrices_are_told():
    damaged = sparse.csc_matrix(GOOD)
    damaged.indices = np.array([0, 7, 0, 1], dtype=np.int32)
    with pytest.raises(ValueError, match="damaged sparse matrix"):
        limit(K=damaged)
    for index in (7, -5, 10**9):
        rows = sparse.csr_matrix(GOOD)
        rows.indices = np.array([0, index, 0, 1], dtype=np.int32)
        pairs = sparse.coo_matrix(GOOD)
        pairs.row = np.array([0, index, 0, 1], dtype=np.int32)
        for each in (rows, pairs):
            with pytest.raises(ValueError, match="damaged sparse matrix"):
                limit(K=each)
    rows = sparse.csr_matrix(GOOD)
    rows.indptr = np.array([0, 2, 10**6], dtype=np.int32)
    with pytest.raises(ValueError, match="damaged sparse matrix"):
        limit(K=rows)
    damaged = sparse.csc_matrix(GOOD)
    damaged.indptr = np.array([0, 100, 4], dtype=np.int32)
    with pytest.raises(ValueError, match="damaged sparse matrix"):
        limit(K=damaged)


def test_what_numpy_holds_otherwise_is_taken_as_it_is_meant():
    expected = limit().h_max
    wide = np.zeros((4, 4))
    wide[::2, ::2] = GOOD
    repeated = sparse.coo_matrix(([100.0, 100.0, -100.0, -100.0, 100.0], ([0, 0, 0, 1, 1], [0, 0, 1, 0, 1])))
    for K in (
        GOOD.astype(int),
        GOOD.astype(np.float32),
        np.asfortranarray(GOOD),
        wide[::2, ::2],
        GOOD.T,
        GOOD.tolist(),
        sparse.csr_matrix(GOOD.astype(np.int16)),
        sparse.lil_matrix(GOOD),
        sparse.csr_array(GOOD),
        repeated,
    ):
        assert limit(K=K).h_max == pytest.approx(expected, rel=1e-12)
    wide_indices = sparse.csc_matrix(GOOD)
    wide_indices.indices, wide_indices.indptr = (part.astype(np.int64) for part in (wide_indices.indices, wide_indices.indptr))
    assert limit(K=wide_indices).h_max == pytest.approx(expected, rel=1e-12)
    unsorted = sparse.csc_matrix((np.array([-100.0, 200.0, -100.0, 100.0]), [1, 0, 0, 1], [0, 2, 4]), shape=(2, 2))
    assert limit(K=unsorted).h_max == pytest.approx(expected, rel=1e-12)
    assert unsorted.indices.tolist() == [1, 0, 0, 1]  # what is given is not changed
    for M in (np.array([0.01, 0.01], dtype=np.float32), np.diag([0.01, 0.01]), sparse.diags([0.01, 0.01])):
        assert limit(M=M).h_max == pytest.approx(expected, rel=1e-6)


def test_masked_entries_are_refused_wherever_arrays_enter():
    def masked(values):
        return np.ma.masked_array(values, mask=np.arange(np.size(values)).reshape(np.shape(values)) == 0)

    hidden = masked([0.01, 0.01])
    body = hmax.Body("cube:n=1")
    state = masked(np.zeros(body.dofs))
    calls = [
        lambda: limit(K=masked(GOOD)),
        lambda: limit(M=hidden),
        lambda: limit(C=masked(GOOD)),
        lambda: limit(K=[hidden, hidden]),
        lambda: hmax.largest_stable_step("rk4", J=masked(GOOD)),
        lambda: hmax.modes(GOOD, hidden),
        lambda: body.K(state),
        lambda: body.C(v=state),
        lambda: body.force(state),
        lambda: body.integrate("rk4", 1e-3, h=1e-4, q0=state),
        lambda: hmax.Body("cube:n=1", gravity=masked([0.0, 0.0, 1.0])),
        lambda: hmax.integrate("rk4", lambda t, y: -y, masked([1.0]), 1, h=0.1),
        lambda: hmax.integrate("rk4", lambda t, y: masked([1.0]), [1.0], 1, h=0.1),
        lambda: hmax.integrate("implicit_euler", lambda t, y: -y, [1.0], 1, h=0.1, jacobian=lambda t, y: masked([[-1.0]])),
        lambda: hmax.probe(lambda y, h: y * 0.9, masked([1.0]), 0.1, 1),
        lambda: hmax.probe(lambda y, h: masked(y * 0.9), [1.0], 0.1, 1),
        lambda: hmax.probe(lambda y, h: y * 0.9, [1.0, 1.0], 0.1, 1, scales=hidden),
        lambda: hmax.probe(lambda y, h: y * 0.9, [1.0, 1.0], 0.1, 1, pattern=masked(np.eye(2))),
        lambda: hmax.predict("liver_cubic", "rk4", y0=hidden),
    ]
    for number, call in enumerate(calls):
        with pytest.raises(ValueError, match="masked"):
            call()
            pytest.fail(f"call {number} took masked entries")
    # A masked array without masked entries holds every number.
    assert limit(M=np.ma.masked_array(MASSES)).h_max == limit().h_max


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_states_of_a_body_must_be_finite(bad):
    body = hmax.Body("cube:n=1")
    state = np.zeros(body.dofs)
    state[3] = bad
    for call in (body.K, body.C, body.force):
        for name in ("q", "v"):
            with pytest.raises(ValueError, match=rf"{name}\[3\] is {bad}; every number must be finite"):
                call(**{name: state})
        with pytest.raises(ValueError, match="t is .* but must be a finite number"):
            call(t=bad)
    with pytest.raises(ValueError, match=r"gravity\[1\]"):
        hmax.Body("cube:n=1", gravity=[0, bad, 0])
    with pytest.raises(ValueError, match=r"pattern\["):
        hmax.probe(lambda y, h: y * 0.9, [1.0], 0.1, 1, pattern=[[bad]])


def test_names_and_counts_are_checked():
    with pytest.raises(ValueError, match="rk4"):
        hmax.limits("rk44")
    with pytest.raises(ValueError, match="cells"):
        hmax.region("rk4", cells=1)
    with pytest.raises(ValueError, match="4000 at most"):
        hmax.region("rk4", cells=10**9)
    for count in (0, -3, 1.5, None, np.inf, np.nan, [2], 1j, "6"):
        with pytest.raises(ValueError, match="count"):
            hmax.modes(GOOD, MASSES, count=count)
    with pytest.raises(ValueError, match="not both symmetric"):
        hmax.modes([[1.0, 2.0], [0.5, 3.0]], MASSES)


def test_the_sentences_are_those_of_the_program(program):
    with pytest.raises(ValueError) as raised:
        hmax.limits("no_such_method")
    told = program("stability", "limits", "--method", "no_such_method").stderr
    assert str(raised.value) in told


def test_what_is_given_is_not_changed():
    K, m, _ = spring_chain(6)
    before = K.copy(), m.copy()
    hmax.largest_stable_step("rk4", K, m)
    hmax.modes(K, m)
    assert (K == before[0]).all() and (m == before[1]).all()

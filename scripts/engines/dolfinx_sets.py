"""Sets of matrices of DOLFINx: soft tissue in SI units, written by PETSc's binary viewer."""
import numpy
import scipy.io
import scipy.sparse
import ufl
from dolfinx import fem, mesh
from dolfinx.fem.petsc import assemble_matrix, assemble_vector
from mpi4py import MPI
from petsc4py import PETSc
from slepc4py import SLEPc

import matrix_set

E, NU, RHO = 5500.0, 0.45, 1060.0


def box(cells, size=(0.2, 0.05, 0.05)):
    return mesh.create_box(MPI.COMM_WORLD, [numpy.zeros(3), numpy.array(size)], cells, mesh.CellType.tetrahedron)


def body_of(mesh_file):
    points, cells = matrix_set.tetrahedra(mesh_file)
    element = ufl.Mesh(ufl.VectorElement("Lagrange", "tetrahedron", 1))
    return mesh.create_mesh(MPI.COMM_WORLD, cells, points, element)


def stress(u, nu=NU):
    mu, lam = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
    strain = ufl.sym(ufl.grad(u))
    return 2 * mu * strain + lam * ufl.tr(strain) * ufl.Identity(len(u))


def elastic(V):
    u, v = ufl.TrialFunction(V), ufl.TestFunction(V)
    return ufl.inner(stress(u), ufl.grad(v)) * ufl.dx


def inertia(V):
    u, v = ufl.TrialFunction(V), ufl.TestFunction(V)
    return RHO * ufl.inner(u, v) * ufl.dx


def held_end(V, domain):
    """The dofs at x = 0 as a condition."""
    dofs = fem.locate_dofs_geometrical(V, lambda x: numpy.isclose(x[0], domain.geometry.x[:, 0].min()))
    return fem.dirichletbc(numpy.zeros(3), dofs, V)


def matrix(form, bcs=(), diagonal=1.0):
    A = assemble_matrix(fem.form(form), bcs=list(bcs), diagonal=diagonal)
    A.assemble()
    return A


def row_sums(V):
    """Lumped masses: the mass form applied to a motion of all unknowns by one."""
    ones = fem.Constant(V.mesh, numpy.ones(3))
    vector = assemble_vector(fem.form(RHO * ufl.inner(ones, ufl.TestFunction(V)) * ufl.dx))
    vector.assemble()
    return vector


def view(thing, file):
    viewer = PETSc.Viewer().createBinary(str(file), "w")
    thing.view(viewer)
    viewer.destroy()


def fastest(K, M):
    """The largest frequency [rad/s] that SLEPc finds for K x = omega^2 M x."""
    solver = SLEPc.EPS().create()
    solver.setOperators(K, M)
    solver.setProblemType(SLEPc.EPS.ProblemType.GHEP)
    solver.setWhichEigenpairs(SLEPc.EPS.Which.LARGEST_REAL)
    solver.setDimensions(1, 60)
    solver.setTolerances(1e-10, 2000)
    solver.solve()
    return solver.getEigenvalue(0).real ** 0.5


def own_frequency(omega):
    """Limits of a largest frequency without damping: of symplectic Euler and of RK4."""
    return [{"what": "SLEPc", "method": "symplectic_euler", "value": 2 / omega, "unit": "s"},
            {"what": "SLEPc", "method": "rk4", "value": 8 ** 0.5 / omega, "unit": "s"}]


def own_steps(K, mass, omega, C=None, guess=None):
    """The limit of symplectic Euler that steps with PETSc's products show."""
    x, y = K.createVecs()
    def force(q, v):
        x.array[:] = q
        K.mult(x, y)
        f = -y.array
        if C is not None:
            x.array[:] = v
            C.mult(x, y)
            f = f - y.array
        return f
    grows = matrix_set.symplectic_euler_grows(force, mass)
    value = matrix_set.largest_step(grows, guess or 2 / omega)
    return [{"what": "steps with PETSc", "method": "symplectic_euler", "value": value, "unit": "s"}]


def diagonal_matrix(vector):
    D = PETSc.Mat().createAIJ((vector.size, vector.size), nnz=1)
    D.setUp()
    D.setDiagonal(vector)
    D.assemble()
    return D


def p1_lumped(folder, mesh_file):
    """A held box; the rows of held unknowns are rows of the unit matrix in K and have their mass."""
    domain = box([12, 4, 4])
    V = fem.VectorFunctionSpace(domain, ("Lagrange", 1))
    K, m = matrix(elastic(V), [held_end(V, domain)]), row_sums(V)
    view(K, folder / "K.petsc")
    view(m, folder / "m.petsc")
    omega = fastest(K, diagonal_matrix(m))
    matrix_set.save(folder, program="DOLFINx", element="P1, identity rows", unknowns=m.size, mass="lumped vector",
                    matrices={"stiffness": "K.petsc", "mass": "m.petsc"},
                    own=own_frequency(omega)[1:] + own_steps(K, m.array.copy(), omega))


def p2_consistent(cells):
    def make(folder, mesh_file):
        """The mass of held unknowns has a zero on the diagonal, which makes them massless."""
        domain = box(cells)
        V = fem.VectorFunctionSpace(domain, ("Lagrange", 2))
        bc = held_end(V, domain)
        K, M = matrix(elastic(V), [bc]), matrix(inertia(V), [bc], 0.0)
        view(K, folder / "K.petsc")
        view(M, folder / "M.petsc")
        regular = matrix(inertia(V), [bc], 1.0)  # the held unknowns at 1 rad/s, out of the way
        matrix_set.save(folder, program="DOLFINx", element="P2, identity rows without mass", unknowns=K.size[0],
                        mass="consistent", matrices={"stiffness": "K.petsc", "mass": "M.petsc"},
                        own=own_frequency(fastest(K, regular)))
    return make


def p1_consistent(folder, mesh_file):
    """A free body, in Matrix Market of SciPy."""
    V = fem.VectorFunctionSpace(body_of(mesh_file), ("Lagrange", 1))
    K, M = matrix(elastic(V)), matrix(inertia(V))
    for A, file in ((K, "K.mtx"), (M, "M.mtx")):
        scipy.io.mmwrite(folder / file, scipy.sparse.csr_matrix(A.getValuesCSR()[::-1], shape=A.size))
    matrix_set.save(folder, program="DOLFINx", element="P1, free body", unknowns=K.size[0], mass="consistent",
                    matrices={"stiffness": "K.mtx", "mass": "M.mtx"}, own=own_frequency(fastest(K, M)))


def large(folder, mesh_file):
    domain = box([64, 22, 22])
    V = fem.VectorFunctionSpace(domain, ("Lagrange", 1))
    K, m = matrix(elastic(V), [held_end(V, domain)]), row_sums(V)
    view(K, folder / "K.petsc")
    view(m, folder / "m.petsc")
    matrix_set.save(folder, program="DOLFINx", element="P1, identity rows", unknowns=m.size, mass="lumped vector",
                    matrices={"stiffness": "K.petsc", "mass": "m.petsc"},
                    own=own_frequency(fastest(K, diagonal_matrix(m))))


def absorbing(folder, mesh_file):
    """The end x = max is a wall of dashpots that absorbs waves (Lysmer and Kuhlemeyer, 1969): C does not follow from M and K."""
    domain = box([12, 4, 4])
    V = fem.VectorFunctionSpace(domain, ("Lagrange", 1))
    u, v = ufl.TrialFunction(V), ufl.TestFunction(V)
    end = domain.geometry.x[:, 0].max()
    facets = mesh.locate_entities_boundary(domain, 2, lambda x: numpy.isclose(x[0], end))
    ds = ufl.Measure("ds", domain, subdomain_data=mesh.meshtags(domain, 2, facets, numpy.full(facets.size, 1, "int32")))
    mu, lam = E / (2 * (1 + NU)), E * NU / ((1 + NU) * (1 - 2 * NU))
    n = ufl.FacetNormal(domain)
    pressure, shear = (RHO * (lam + 2 * mu)) ** 0.5, (RHO * mu) ** 0.5
    dashpots = (pressure * ufl.dot(u, n) * ufl.dot(v, n) + shear * ufl.dot(u - ufl.dot(u, n) * n, v)) * ds(1)
    bc = held_end(V, domain)
    K, C, m = matrix(elastic(V), [bc]), matrix(dashpots, [bc], 0.0), row_sums(V)
    for thing, file in ((K, "K.petsc"), (C, "C.petsc"), (m, "m.petsc")):
        view(thing, folder / file)
    omega = fastest(K, diagonal_matrix(m))
    matrix_set.save(folder, program="DOLFINx", element="P1, absorbing end", unknowns=m.size, mass="lumped vector",
                    matrices={"stiffness": "K.petsc", "mass": "m.petsc", "damping": "C.petsc"},
                    own=own_steps(K, m.array.copy(), omega, C))


def follower(folder, mesh_file):
    """A pressure that follows the surface, on all of it but the held end: its stiffness is not symmetric."""
    domain = box([8, 3, 3])
    V = fem.VectorFunctionSpace(domain, ("Lagrange", 1))
    q, v = fem.Function(V), ufl.TestFunction(V)
    F = ufl.Identity(3) + ufl.grad(q)
    n = ufl.FacetNormal(domain)
    pushed = 800.0 * ufl.inner(ufl.det(F) * ufl.inv(F).T * n, v) * ufl.ds
    force = ufl.inner(stress(q), ufl.grad(v)) * ufl.dx + pushed
    bc = held_end(V, domain)
    K, m = matrix(ufl.derivative(force, q), [bc]), row_sums(V)
    view(K, folder / "K.petsc")
    view(m, folder / "m.petsc")
    omega = fastest(matrix(elastic(V), [bc]), diagonal_matrix(m))
    matrix_set.save(folder, program="DOLFINx", element="P1, follower pressure", unknowns=m.size, mass="lumped vector",
                    matrices={"stiffness": "K.petsc", "mass": "m.petsc"}, own=own_steps(K, m.array.copy(), omega))


def taylor_hood(folder, mesh_file):
    """Nearly incompressible tissue with pressures, which have no mass."""
    domain = box([4, 2, 2])
    nu = 0.4999
    mu, lam = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
    cell = domain.ufl_cell()
    W = fem.FunctionSpace(domain, ufl.MixedElement(ufl.VectorElement("Lagrange", cell, 2), ufl.FiniteElement("Lagrange", cell, 1)))
    (u, p), (v, r) = ufl.TrialFunctions(W), ufl.TestFunctions(W)
    a = (2 * mu * ufl.inner(ufl.sym(ufl.grad(u)), ufl.grad(v)) - p * ufl.div(v) - r * ufl.div(u) - p * r / lam) * ufl.dx
    V = W.sub(0)
    space, _ = V.collapse()
    dofs = fem.locate_dofs_geometrical((V, space), lambda x: numpy.isclose(x[0], 0))
    bc = fem.dirichletbc(fem.Function(space), dofs, V)
    K, M = matrix(a, [bc]), matrix(RHO * ufl.inner(u, v) * ufl.dx, [bc], 0.0)
    view(K, folder / "K.petsc")
    view(M, folder / "M.petsc")
    matrix_set.save(folder, program="DOLFINx", element="P2/P1, nu 0.4999, pressures without mass", unknowns=K.size[0],
                    mass="consistent", matrices={"stiffness": "K.petsc", "mass": "M.petsc"})


SETS = {
    "dolfinx_p1_lumped": p1_lumped,
    "dolfinx_p1_consistent": p1_consistent,
    "dolfinx_p2_consistent": p2_consistent([4, 2, 2]),
    "dolfinx_p2_large": p2_consistent([12, 4, 4]),
    "dolfinx_absorbing": absorbing,
    "dolfinx_follower": follower,
    "dolfinx_taylor_hood": taylor_hood,
    "dolfinx_p1_large": large,
}

if __name__ == "__main__":
    matrix_set.make(SETS)

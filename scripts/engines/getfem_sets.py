"""Sets of matrices of GetFEM in SI units, written by its own Matrix Market writer."""
import getfem as gf
import numpy

import matrix_set

gf.util("trace level", 0)
E, NU, RHO = 5500.0, 0.45, 1060.0
MU, LAMBDA = E / (2 * (1 + NU)), E * NU / ((1 + NU) * (1 - 2 * NU))
LEFT = 1


def spaces(mesh, degree, components, integration):
    mf = gf.MeshFem(mesh, components)
    mf.set_classical_fem(degree)
    return mf, gf.MeshIm(mesh, gf.Integ(integration) if isinstance(integration, str) else integration)


def with_left(mesh):
    """The faces at the least x are the region LEFT."""
    x = mesh.pts()[0]
    mesh.set_region(LEFT, mesh.faces_from_pid(numpy.flatnonzero(x < x.min() + 1e-9)))
    return mesh


def model_of(mf, name="u"):
    md = gf.Model("real")
    md.add_fem_variable(name, mf)
    return md


def elastic(md, mim):
    md.add_initialized_data("lambda", LAMBDA)
    md.add_initialized_data("mu", MU)
    md.add_isotropic_linearized_elasticity_brick(mim, "u", "lambda", "mu")


def stiffness(md):
    md.assembly("build_matrix")
    return md.tangent_matrix()


def mass(mim, mf, rho=RHO):
    M = gf.asm_mass_matrix(mim, mf)
    M.scale(rho)
    return M


def saved(folder, **matrices):
    for file, A in matrices.items():
        A.save("mm", str(folder / f"{file}.mtx"))


def own_steps(K, masses, omega, beta):
    """The limit of symplectic Euler that steps with GetFEM's products shows."""
    grows = matrix_set.symplectic_euler_grows(lambda q, v: -K.mult(q + beta * v), masses)
    guess = (-beta * omega + (beta * beta * omega * omega + 4) ** 0.5) / omega
    return [{"what": "steps with GetFEM", "method": "symplectic_euler", "unit": "s",
             "value": matrix_set.largest_step(grows, guess)}]


def sums(M):
    return M.mult(numpy.ones(M.size()[1]))


def fastest(K, masses):
    """The largest frequency [rad/s] by power iteration with GetFEM's products."""
    x = numpy.random.default_rng(2).standard_normal(masses.size)
    for _ in range(1000):
        y = K.mult(x / masses ** 0.5) / masses ** 0.5
        kappa = x @ y / (x @ x)
        x = y / numpy.linalg.norm(y)
    return kappa ** 0.5


def plane_strain_penalty(folder, mesh_file):
    """Q2 in plane strain; GetFEM's penalty on the left edge is 1e9 times a mass matrix of that edge."""
    mesh = with_left(gf.Mesh("cartesian", numpy.linspace(0, 0.2, 17), numpy.linspace(0, 0.05, 5)))
    mf, mim = spaces(mesh, 2, 2, 4)
    md = model_of(mf)
    elastic(md, mim)
    md.add_Dirichlet_condition_with_penalization(mim, "u", 1e9, LEFT)
    K, M = stiffness(md), mass(mim, mf)
    saved(folder, K=K, M=M)
    matrix_set.save(folder, program="GetFEM", element="Q2 plane strain, penalty", unknowns=int(M.size()[0]), mass="consistent",
                    matrices={"stiffness": "K.mtx", "mass": "M.mtx"})


def plane_strain_multipliers(folder, mesh_file):
    """The same, held by Lagrange multipliers, which have no mass and no stiffness among themselves."""
    mesh = with_left(gf.Mesh("cartesian", numpy.linspace(0, 0.2, 17), numpy.linspace(0, 0.05, 5)))
    mf, mim = spaces(mesh, 2, 2, 4)
    md = model_of(mf)
    elastic(md, mim)
    md.add_Dirichlet_condition_with_multipliers(mim, "u", mf, LEFT)
    K, free = stiffness(md), mass(mim, mf)
    M = gf.Spmat("empty", K.size()[0])
    u = md.interval_of_variable("u")
    rows = numpy.arange(u[0], u[0] + u[1])
    M.assign(rows, rows, free)
    saved(folder, K=K, M=M)
    matrix_set.save(folder, program="GetFEM", element="Q2 plane strain, multipliers", unknowns=int(K.size()[0]),
                    mass="consistent", matrices={"stiffness": "K.mtx", "mass": "M.mtx"})


def plate(folder, mesh_file):
    """A held Mindlin plate, 2 mm thick; the rotations have no inertia, as GetFEM's mass of u3 alone has it."""
    mesh = with_left(gf.Mesh("cartesian", numpy.linspace(0, 0.1, 9), numpy.linspace(0, 0.1, 9)))
    mf, mim = spaces(mesh, 2, 1, 4)
    mf_theta, _ = spaces(mesh, 2, 2, 4)
    md = gf.Model("real")
    md.add_fem_variable("u3", mf)
    md.add_fem_variable("theta", mf_theta)
    for name, value in (("E", E), ("nu", NU), ("h", 2e-3), ("kappa", 5 / 6)):
        md.add_initialized_data(name, value)
    mim_reduced = gf.MeshIm(mesh, gf.Integ("IM_GAUSS_PARALLELEPIPED(2,2)"))
    md.add_Mindlin_Reissner_plate_brick(mim, mim_reduced, "u3", "theta", "E", "nu", "h", "kappa", 2)
    md.add_Dirichlet_condition_with_penalization(mim, "u3", 1e3, LEFT)
    md.add_Dirichlet_condition_with_penalization(mim, "theta", 1e3, LEFT)
    K, free = stiffness(md), mass(mim, mf, RHO * 2e-3)
    M = gf.Spmat("empty", K.size()[0])
    first, count = md.interval_of_variable("u3")
    rows = numpy.arange(first, first + count)
    M.assign(rows, rows, free)
    saved(folder, K=K, M=M)
    matrix_set.save(folder, program="GetFEM", element="Mindlin plate Q2, rotations without mass", unknowns=int(K.size()[0]),
                    mass="consistent", matrices={"stiffness": "K.mtx", "mass": "M.mtx"})


def body(folder, mesh_file):
    """The body in P1 with Rayleigh damping: limits of damped modes."""
    points, cells = matrix_set.tetrahedra(mesh_file)
    mesh = gf.Mesh("empty", 3)
    mesh.add_convex(gf.GeoTrans("GT_PK(3,1)"), points[cells].transpose(0, 2, 1).transpose(1, 2, 0))
    mf, mim = spaces(mesh, 1, 3, "IM_TETRAHEDRON(2)")
    md = model_of(mf)
    elastic(md, mim)
    K, M = stiffness(md), mass(mim, mf)
    saved(folder, K=K, M=M)
    masses, beta = sums(M), 1e-3
    matrix_set.save(folder, program="GetFEM", element="P1, free body, Rayleigh", unknowns=int(K.size()[0]), mass="row sums",
                    matrices={"stiffness": "K.mtx", "mass": "lumped:M.mtx"}, options=["--beta", repr(beta)],
                    own=own_steps(K, masses, fastest(K, masses), beta))


def travelling(folder, mesh_file):
    """A membrane in air that travels along x: 2 rho c is a gyroscopic damping, K has the centrifugal -rho c^2."""
    mesh = with_left(gf.Mesh("cartesian", numpy.linspace(0, 0.2, 9), numpy.linspace(0, 0.1, 5)))
    mf, mim = spaces(mesh, 1, 1, 2)
    tension, speed, rho, air = 10.0, 2.0, 1.0, 100.0
    mesh.set_region(2, mesh.outer_faces())
    md = model_of(mf)
    md.add_linear_term(mim, f"{tension} * Grad_u . Grad_Test_u - {rho * speed ** 2} * [1;0].Grad_u * [1;0].Grad_Test_u")
    md.add_Dirichlet_condition_with_penalization(mim, "u", 1e4, 2)
    damping = model_of(mf)
    damping.add_linear_term(mim, f"{rho * speed} * ([1;0].Grad_u * Test_u - u * [1;0].Grad_Test_u) + {air} * u * Test_u")
    K, C, M = stiffness(md), stiffness(damping), mass(mim, mf, rho)
    saved(folder, K=K, C=C, M=M)
    matrix_set.save(folder, program="GetFEM", element="Q1 travelling membrane", unknowns=int(K.size()[0]), mass="row sums",
                    matrices={"stiffness": "K.mtx", "mass": "lumped:M.mtx", "damping": "C.mtx"})


SETS = {
    "getfem_plane_strain": plane_strain_penalty,
    "getfem_multipliers": plane_strain_multipliers,
    "getfem_plate": plate,
    "getfem_body": body,
    "getfem_travelling": travelling,
}

if __name__ == "__main__":
    matrix_set.make(SETS)

"""Meshes, bodies and advice against differences, sums and the program."""

import json

import hmax
import numpy as np
import pytest
import scipy.sparse as sparse
from conftest import spring_chain

GMSH = """$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
5
1 0 0 0
2 10 0 0
3 0 10 0
4 0 0 10
5 10 10 10
$EndNodes
$Elements
2
1 4 2 1 1 1 2 3 4
2 4 2 1 1 2 3 4 5
$EndElements
"""


def test_meshes_by_name_have_the_published_counts():
    liver = hmax.read_mesh("liver")
    assert liver.points.shape == (299, 3) and liver.tetrahedra.shape == (1151, 4) and liver.regions.shape == (1151,)
    corners = liver.points[liver.tetrahedra]
    assert (np.linalg.det(corners[:, 1:] - corners[:, :1]) > 0).all()


def test_points_have_the_numbers_that_supports_take():
    small, large = hmax.read_mesh("cube:n=2"), hmax.read_mesh("cube:n=10")  # the latter is renumbered
    assert (small.point_numbers == np.arange(1, 28)).all()
    assert sorted(large.point_numbers) == list(range(1, 1332))
    # Points of a cube are numbered along x first: the second one is at the first step of the grid.
    second = large.points[list(large.point_numbers).index(2)]
    assert np.abs(second - hmax.read_mesh("cube:n=10").points.min(axis=0)).sum() == pytest.approx(0.01)
    assert not (large.point_numbers == np.arange(1, 1332)).all()


def test_a_mesh_file_is_read_in_the_unit_that_is_told(tmp_path):
    file = tmp_path / "two.msh"
    file.write_text(GMSH)
    mesh = hmax.read_mesh(file, unit="mm")
    assert sorted(map(tuple, mesh.points.round(9))) == [
        (0, 0, 0), (0, 0, 0.01), (0, 0.01, 0), (0.01, 0, 0), (0.01, 0.01, 0.01)
    ]
    assert hmax.read_mesh(file, unit=0.001).points.max() == mesh.points.max()
    with pytest.raises(ValueError, match="unit"):
        hmax.read_mesh(file)
    with pytest.raises(ValueError, match="furlong"):
        hmax.read_mesh(file, unit="furlong")
    body = hmax.Body(mesh, "fem_green", supports=["points:1"])
    assert body.dofs == 12
    file.write_text(GMSH.replace("2 4 2 1 1 2 3 4 5", "2 4 2 1 1 2 3 4 99"))
    with pytest.raises(ValueError, match="two.msh"):
        hmax.read_mesh(file, unit="mm")


def test_regions_have_the_numbers_of_the_file(tmp_path):
    file = tmp_path / "two.msh"
    file.write_text(GMSH.replace("1 4 2 1 1 1 2 3 4", "1 4 2 30 1 1 2 3 4").replace("2 4 2 1 1 2 3 4 5", "2 4 2 20 1 2 3 4 5"))
    mesh = hmax.read_mesh(file, unit="mm")
    corners = np.sort(mesh.point_numbers[mesh.tetrahedra], axis=1).tolist()
    assert dict(zip(map(tuple, corners), mesh.regions)) == {(1, 2, 3, 4): 30, (2, 3, 4, 5): 20}


def test_a_mesh_is_not_written_to():
    mesh = hmax.read_mesh("cube:n=2")
    for array in (mesh.points, mesh.point_numbers, mesh.tetrahedra, mesh.regions):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


def test_free_points_are_places_in_the_points_of_the_body():
    # The lowest tenth is fixed, of a quadratic body also the middles of edges there.
    for model in ("fem_green", "fem_quadratic"):
        body = hmax.Body("cube:n=2", model)
        z = body.points[:, 2]
        assert (np.sort(body.free_points) == np.flatnonzero(z > z.min() + 0.1 * np.ptp(z))).all()
    assert len(body.points) == 125


def test_forces_are_those_of_the_stiffness_and_the_damping():
    body = hmax.Body("phantom", "fem_neo_hookean", E=5500, nu=0.4, alpha=0.1, beta=0.01)
    generator = np.random.default_rng(1)
    q, v, d = (scale * generator.standard_normal(body.dofs) for scale in (1e-3, 1e-2, 1))
    e = 1e-6
    dq = (body.force(q + e * d, v) - body.force(q - e * d, v)) / (2 * e)
    dv = (body.force(q, v + e * d) - body.force(q, v - e * d)) / (2 * e)
    np.testing.assert_allclose(-(body.K(q, v) @ d), dq, rtol=1e-5, atol=1e-5 * np.abs(dq).max())
    np.testing.assert_allclose(-(body.C(q, v) @ d), dv, rtol=1e-5, atol=1e-5 * np.abs(dv).max())
    assert sparse.issparse(body.K()) and body.K().shape == (body.dofs, body.dofs)
    assert len(body.free_points) == body.dofs // 3


def test_masses_are_those_of_the_volumes():
    # Supported points have mass too: half the body is held in none of the masses of M.
    mesh = hmax.read_mesh("phantom")
    body = hmax.Body(mesh, "fem_green", rho=1060)
    corners = mesh.points[mesh.tetrahedra]
    volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    masses = np.zeros(len(mesh.points))
    np.add.at(masses, mesh.tetrahedra.ravel(), np.repeat(1060 * volumes / 4, 4))
    np.testing.assert_allclose(body.M().diagonal()[::3], masses[body.free_points], rtol=1e-10)


def test_the_limit_of_a_body_is_that_of_the_program(program):
    body = hmax.Body("phantom", "fem_corotational", E=4000, g=0)
    limit = hmax.largest_stable_step("rk4", body.K(), body.M(), body.C())
    told = program("stability", "predict", "--mesh", "phantom", "--model", "fem_corotational", "--set", "E=4000", "--set", "g=0", "--methods", "rk4", "--json")
    assert limit.h_max == pytest.approx(json.loads(told.stdout)["rows"][0]["h_max"], rel=1e-9)


def test_a_body_moves_as_its_matrices_do():
    body = hmax.Body("phantom", "fem_cauchy", E=4000, alpha=0, beta=0, g=0)  # linear
    v0 = np.random.default_rng(2).standard_normal(body.dofs)
    run = body.integrate("rk4", 0.01, h=1e-4, v0=v0)
    other = hmax.integrate("rk4", K=body.K(), M=body.M(), y0=np.concatenate([0 * v0, v0]), t_end=0.01, h=1e-4)
    assert run.outcome == other.outcome == "reached_end"
    np.testing.assert_allclose(run.y[-1], other.y[-1], rtol=1e-6, atol=1e-9 * np.abs(other.y[-1]).max())


def test_a_run_has_the_bits_of_the_program(program):
    body = hmax.Body("phantom", "fem_neo_hookean", load="press")
    told = program("run", "--mesh", "phantom", "--model", "fem_neo_hookean", "--load", "press", "--method", "rk4",
                   "--h", "0.0005", "--t-end", "0.02", "--full", "--json")
    run = body.integrate("rk4", 0.02, h=0.0005)
    assert run.y[-1].any()
    assert run.y[-1].tolist() == json.loads(told.stdout)["y"]


def test_advice_has_the_keys_of_the_program(program):
    told = json.loads(
        program("advise", "--problem", "liver_forced", "--rate", "100", "--methods", "rk4,newmark", "--frames", "50", "--json").stdout
    )
    found = hmax.advise("liver_forced", rate=100, methods=["rk4", "newmark"], frames=50)
    assert list(found) == list(told)
    for ours, theirs in zip(sorted(found.rows, key=lambda row: row.method), sorted(told["rows"], key=lambda row: row["method"])):
        assert list(ours) == list(theirs)
        assert ours.h_max == pytest.approx(theirs["h_max"]) if theirs["h_max"] != "unbounded" else ours.h_max == np.inf


def test_advice_takes_a_body():
    body = hmax.Body("phantom", "mass_spring", material="liver:male_normal")
    found = hmax.advise(body, rate=30, methods=["symplectic_euler"], frames=20)
    assert found.model == body.id and found.recommended.method == "symplectic_euler"
    limit = hmax.largest_stable_step("symplectic_euler", body.K(), body.M(), body.C())
    assert found.recommended.h < 1.5 * limit.h_max


def test_advice_takes_matrices():
    K, m, omega = spring_chain(6)
    found = hmax.advise(K=K, M=m, C=1e-3 * K, y0=[0.01] * 6 + [0] * 6, t_end=1, rate=100, methods=["rk4"], frames=20)
    (row,) = found.rows
    damped = hmax.largest_stable_step("rk4", K, m, 1e-3 * K).h_max
    assert row.h_max == pytest.approx(damped, rel=1e-6)
    assert row.verdict == "recommended" and row.h < damped


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: hmax.Body("lver"), "did you mean 'liver'"),
        (lambda: hmax.Body("liver", "fem_gren"), "fem_green"),
        (lambda: hmax.Body("liver", stiffness=3), "unknown parameter 'stiffness'"),
        (lambda: hmax.Body("liver", E="soft"), "must be a number"),
        (lambda: hmax.Body("liver", E=np.nan), "E"),
        (lambda: hmax.Body("liver", E=None), "E is None"),
        (lambda: hmax.Body("liver", supports=3), "supports is 3"),
        (lambda: hmax.Body("liver", gravity=[1, 2]), "vector of three"),
        (lambda: hmax.Body("liver", gravity=[0, 0, -1], gz=-5), "gravity and gz say the same"),
        (lambda: hmax.Body("liver", supports=["nowhere"]), "nowhere"),
        (lambda: hmax.Body("liver", unit="mm"), "metres"),
        (lambda: hmax.Body(None), "None"),
        (lambda: hmax.Body("phantom").K(q=[1, 2]), "q has 2 numbers but must have"),
        (lambda: hmax.Body("phantom").force(v="x"), "no real numbers"),
        (lambda: hmax.Body("phantom").integrate("rk4", 1, h=0.1, q0=[1]), "q0 has 1 numbers"),
        (lambda: hmax.read_mesh("no.msh", unit="mm"), "no.msh"),
        (lambda: hmax.advise("liver_forced", rate=0), "rate is 0"),
        (lambda: hmax.advise("liver_forced", rate=None), "rate is None"),
        (lambda: hmax.advise("liver_forced", rate=100, tolerance=2), "tolerance is 2"),
        (lambda: hmax.advise("liver_forced", rate=100, methods=["rk44"]), "rk4"),
        (lambda: hmax.advise("liver_forcd", rate=100), "liver_forced"),
        (lambda: hmax.advise(3, rate=100), "must be a Body"),
        (lambda: hmax.advise(rate=100), "K and the mass M, or a model$"),
        (lambda: hmax.advise(K=[[1.0]], M=[1.0], rate=100), "y0 is missing"),
        (lambda: hmax.advise(K=[[1.0]], M=[1.0], y0=[1.0], rate=100), "1 numbers but must have 2"),
        (lambda: hmax.advise("liver_forced", K=[[1.0]], rate=100), "both given"),
        (lambda: hmax.advise("liver_forced", rate=100, t_end=3), "t_end is of matrices"),
        (lambda: hmax.advise(K=[[1.0]], M=[1.0], y0=[1.0, 0], rate=100, alpha=5), "alpha is of a model"),
        (lambda: hmax.advise(K=[[1.0]], M=[1.0], y0=[1.0, 0], rate=100, material="x"), "material is of a model"),
        (lambda: hmax.integrate("newmark", K=[[1.0]], M=[1.0], y0=[1, 0], t_end=1, h=0.1, atol=1), "atol is of adaptive"),
        (lambda: hmax.integrate("newmark", K=[[1.0]], M=[1.0], y0=[1, 0], t_end=1, h=0.1, jacobian=len), "is of rhs"),
        (lambda: hmax.Body(hmax.read_mesh("liver"), unit="mm"), "unit is 'mm'"),
        (lambda: hmax.advise("liver_forced", rate=100, k9=3), "k9"),
        (lambda: hmax.advise("liver_forced", rate=100, frames=0), "frames"),
    ],
)
def test_wrong_input_is_told(call, words):
    with pytest.raises(ValueError, match=words):
        call()


def test_limits_of_a_model_are_those_of_the_program(program):
    for options, body in (
        (["--load", "gravity"], hmax.Body("cube:n=2", load="gravity")),
        (["--load", "gravity", "--at", "rest"], hmax.Body("cube:n=2", load="gravity")),
        (["--load", "gravity", "--along", "load"], hmax.Body("cube:n=2", load="gravity")),
        (["--load", "breathing", "--t-end", "0.5"], hmax.Body("cube:n=2", load="breathing")),
    ):
        run = program("stability", "predict", "--mesh", "cube:n=2", *options, "--methods", "rk4,newmark", "--json")
        told = json.loads(run.stdout)
        asked = {"at": "rest"} if "rest" in options else {}
        if "--along" in options:
            asked["along"] = "load"
        if "--t-end" in options:
            asked["t_end"] = 0.5
        answer = hmax.predict(body, ["rk4", "newmark"], **asked)
        assert len(answer.rows) == len(told["rows"]) == 2
        for row, expected in zip(answer.rows, told["rows"]):
            assert row.method == expected["method"] and row.state_kind == expected["state_kind"]
            assert row.h_max == pytest.approx(np.inf if expected["h_max"] == "unbounded" else expected["h_max"], rel=1e-9)
            assert ("along" in row) == ("along" in expected)
    assert hmax.predict("liver_linear", "explicit_euler", m=2, c=1, k1=8).rows[0].h_max == pytest.approx(1 / 8)
    with pytest.raises(ValueError, match="rest"):
        hmax.predict("liver_linear", "rk4", at="rest")
    with pytest.raises(ValueError, match="no method"):
        hmax.predict("liver_linear", [])
    family = hmax.predict("van_der_pol", "structural,rk4".split(","), along="none")
    assert [row.method for row in family.rows] == ["rk4"] and "van_der_pol" in family.left_out[0]
    with pytest.raises(ValueError, match="along"):
        hmax.predict("liver_linear", "rk4", along="path")

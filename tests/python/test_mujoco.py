"""hmax.check, with the scenes and the library that `hmax probe` is held against."""

import json
import pathlib

import hmax
import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco", reason="without libmujoco-dev, or its Python package")

SCENES = pathlib.Path(__file__).resolve().parents[2] / "scripts/engines/scenes"

# One joint without damping: J x'' = -k x by semi-implicit Euler, stable up to 2 sqrt(J / k).
HINGE = """<mujoco><option timestep="{h}" gravity="0 0 0"/><worldbody><body>
<joint name="hinge" type="hinge" axis="0 1 0" stiffness="{k}"/><inertial pos="0 0 0" mass="1" diaginertia="1 {J} 1"/>
</body></worldbody></mujoco>"""

# (h / 0.005 - 1) (h / 0.08 - 1) = 1 at h = 0.085
MUSCLE = """<mujoco><worldbody><site name="a" pos="0.05 0 1"/><body pos="0 0 1"><joint axis="0 1 0" damping="0.05"/>
<geom type="capsule" fromto="0 0 0 0 0 -.3" size=".02" mass="1"/><site name="b" pos="0.02 0 -.1"/></body></worldbody>
<tendon><spatial name="t"><site site="a"/><site site="b"/></spatial></tendon>
<actuator><muscle tendon="t" force="200" ctrllimited="true" ctrlrange="0 1"/></actuator></mujoco>"""


def scene(tmp_path, text):
    file = tmp_path / "scene.xml"
    file.write_text(text)
    return mujoco.MjModel.from_xml_path(str(file))


def test_a_hinge_has_the_limit_of_an_oscillator(tmp_path):
    model = scene(tmp_path, HINGE.format(h=0.05, k=100, J=0.25))
    found = hmax.check(model)
    assert found.h_max == pytest.approx(2 * np.sqrt(0.25 / 100), rel=1e-3)
    assert found.gap == pytest.approx(0, abs=5e-3)
    assert (found.timestep, found.stable, found.substeps) == (0.05, True, 1)
    assert model.opt.timestep == 0.05


def test_more_substeps_than_one_where_the_timestep_is_too_long(tmp_path):
    found = hmax.check(scene(tmp_path, HINGE.format(h=0.22, k=100, J=0.25)))
    assert (found.stable, found.substeps) == (False, 3)


@pytest.mark.parametrize("name", ["cable", "robot_arm", "stack"])
def test_scenes_have_the_limit_of_the_program(program, name):
    file = str(SCENES / f"{name}.xml")
    told = program("probe", file, "--no-runs", "--json")
    if told.returncode != 0:
        pytest.skip(told.stderr)
    found = hmax.check(mujoco.MjModel.from_xml_path(file), verify=False)
    assert found.h_max == pytest.approx(json.loads(told.stdout)["h_max"], rel=1e-3)


ROLLING = """<mujoco><worldbody><geom type="plane" size="9 9 0.1"/><geom size="0.2" pos="0 0 0.1"/>
<body pos="0.05 0 1"><freejoint/><geom size="0.1" mass="1"/></body></worldbody></mujoco>"""


def test_what_falls_and_rolls_without_end_is_brought_to_rest_and_the_model_is_left_as_it_was(tmp_path):
    model = scene(tmp_path, ROLLING)
    found = hmax.check(model, verify=False)
    assert (found.state, found.h_max, found.stable) == ("equilibrium", np.inf, True)
    assert not model.dof_damping.any()


def test_a_muscle_at_rest_is_judged_at_its_kink(tmp_path):
    found = hmax.check(scene(tmp_path, MUSCLE), h0=1e-3)
    assert found.smoothness == "kink"
    assert found.h_max == pytest.approx(0.085, rel=3e-3)
    assert found.gap == pytest.approx(0, abs=5e-3)


def test_data_gives_the_beginning_and_its_controls_and_stays_as_it_is(tmp_path):
    model = mujoco.MjModel.from_xml_path(str(SCENES / "robot_arm.xml"))
    data = mujoco.MjData(model)
    data.ctrl[:] = 0.1
    mujoco.mj_step(model, data)
    before = data.qpos.copy()
    found = hmax.check(model, data, verify=False)
    assert found.state == "equilibrium"
    assert np.array_equal(data.qpos, before)


def test_warnings_are_given_back_and_written_nowhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mujoco.set_mju_user_warning(print)
    found = hmax.check(scene(tmp_path, HINGE.format(h=0.22, k=100, J=0.25)), verify=False)
    assert found.stable is False
    assert mujoco.get_mju_user_warning() is print
    mujoco.set_mju_user_warning(None)
    assert [path.name for path in tmp_path.iterdir()] == ["scene.xml"]


def test_a_timestep_beyond_h1_is_not_judged(tmp_path):
    found = hmax.check(scene(tmp_path, HINGE.format(h=0.22, k=100, J=0.25)), h1=0.08, verify=False)
    assert (found.h_max, found.stable, found.substeps) == (np.inf, None, None)


def test_says_what_is_wrong(tmp_path):
    with pytest.raises(ValueError, match="model is no mujoco.MjModel"):
        hmax.check("model.xml")
    model = scene(tmp_path, HINGE.format(h=0.05, k=400, J=0.25))
    with pytest.raises(ValueError, match="data is no mujoco.MjData"):
        hmax.check(model, model)
    with pytest.raises(ValueError, match="nothing in the scene moves"):
        hmax.check(scene(tmp_path, "<mujoco><worldbody><geom size='1'/></worldbody></mujoco>"))

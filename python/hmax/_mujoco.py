"""Scenes of the Python package mujoco."""

from typing import Any, List, Optional

import numpy as np

from . import _core
from ._answer import Answer
from ._arguments import number
from ._probe import probe


def check(
    model: Any, data: Any = None, h0: Optional[float] = None, h1: Optional[float] = None, motion: Optional[float] = None, verify: bool = True
) -> Answer:
    """Whether a scene of the Python package mujoco is stable at its timestep, and its largest stable step.

    The package itself steps, with the integrator, the controls and the contacts of the scene, by its public calls, which were tried with
    MuJoCo 2.2.2. The scene settles first, as that of `hmax probe model.xml` does; where it does not come to rest, the limit is that of where it begins.
    `hmax probe model.xml` tells also which part of a file owns the limit.

    Parameters
    ----------
    model : mujoco.MjModel
    data : mujoco.MjData, the state to begin with and its controls; None: the initial state
    h0, h1 : the smallest and the largest step size to look at [s]; a hundredth and a hundred times the timestep
    motion : follow the motion of this length [s] from the state to begin with instead
    verify : also run the scene on both sides of the limit

    Model and data are left as they are. Returns the keys of hmax.probe with `own_step`: `timestep`, `stable`, `substeps`, `h_max`, ...

    Raises ValueError for input that is wrong, ImportError without the package mujoco.

    >>> import hmax
    >>> import mujoco  # doctest: +SKIP
    >>> found = hmax.check(mujoco.MjModel.from_xml_path("model.xml"))  # doctest: +SKIP
    >>> print(f"{found.timestep} s of at most {found.h_max:.3g} s")  # doctest: +SKIP
    0.002 s of at most 0.0131 s
    """
    import mujoco

    if not isinstance(model, mujoco.MjModel):
        raise ValueError("model is no mujoco.MjModel; give one, as of mujoco.MjModel.from_xml_path")
    if data is not None and not isinstance(data, mujoco.MjData):
        raise ValueError("data is no mujoco.MjData; give that of the model, or leave it out")
    if model.nv == 0:
        raise ValueError("nothing in the scene moves; give a body a joint")
    timestep = float(model.opt.timestep)
    if not timestep > 0:
        raise ValueError("the timestep of the model is not positive; give one like 0.002")
    scene = _Scene(mujoco, model, data)
    # Warnings of steps that diverge would be written to a file in the folder of the user.
    warn = getattr(mujoco, "get_mju_user_warning", lambda: None)()
    set_warning = getattr(mujoco, "set_mju_user_warning", lambda function: None)
    set_warning(lambda text: None)
    try:
        return probe(
            scene.step,
            scene.settle() if motion is None else scene.state(),
            h0=timestep / 100 if number("h0", h0) is None else h0,
            h1=(100 * timestep if motion is None else min(100 * timestep, motion)) if number("h1", h1) is None else h1,
            save=scene.save,
            restore=scene.restore,
            motion=motion,
            verify=verify,
            quaternions=scene.quaternions(),
            scales=scene.scales(),
            name="MuJoCo " + mujoco.mj_versionString(),
            own_step=timestep,
        )
    finally:
        model.opt.timestep = timestep
        set_warning(warn)


class _Scene:
    """A copy of the data of a model, as a step of hmax.probe: its state is qpos, qvel and the activations; the start of the solver and
    the time are kept beside it."""

    def __init__(self, mujoco: Any, model: Any, data: Any) -> None:
        self._mujoco, self._model = mujoco, model
        self._data = mujoco.MjData(model)
        if data is not None:
            mujoco.mj_copyData(self._data, model, data)
        self._begin = mujoco.MjData(model)
        mujoco.mj_copyData(self._begin, model, self._data)
        kinds = mujoco.mjtWarning
        self._reset_kinds = [int(kind) for kind in (kinds.mjWARN_BADQPOS, kinds.mjWARN_BADQVEL, kinds.mjWARN_BADQACC)]
        self._before = self._resets()

    def state(self) -> Any:
        return np.concatenate([self._data.qpos, self._data.qvel, self._data.act])

    def step(self, y: Any, h: float) -> Any:
        data, model = self._data, self._model
        positions, moving = model.nq, model.nq + model.nv
        data.qpos[:], data.qvel[:], data.act[:] = y[:positions], y[positions:moving], y[moving:]
        model.opt.timestep = h
        self._mujoco.mj_step(model, data)
        if self._resets() == self._before:
            return self.state()
        # What diverges MuJoCo puts back to its initial state, without the controls.
        self._put_back()
        return np.full(len(y), np.nan)

    def save(self) -> Any:
        return self._data.qacc_warmstart.copy(), self._data.time

    def restore(self, kept: Any) -> None:
        self._data.qacc_warmstart[:], self._data.time = kept

    def quaternions(self) -> List[int]:
        free, ball = (int(kind) for kind in (self._mujoco.mjtJoint.mjJNT_FREE, self._mujoco.mjtJoint.mjJNT_BALL))
        joints = zip(self._model.jnt_type, self._model.jnt_qposadr)
        return [int(first) + (3 if kind == free else 0) for kind, first in joints if kind in (free, ball)]

    def scales(self) -> Any:
        """Lengths as large as the bodies, angles and all others as 1."""
        model = self._model
        scale = np.ones(model.nq + model.nv + model.na)
        counts = {int(self._mujoco.mjtJoint.mjJNT_FREE): 3, int(self._mujoco.mjtJoint.mjJNT_SLIDE): 1}
        for kind, position, velocity in zip(model.jnt_type, model.jnt_qposadr, model.jnt_dofadr):
            count = counts.get(int(kind), 0)
            scale[position : position + count] = scale[model.nq + velocity : model.nq + velocity + count] = model.stat.meansize
        return scale

    def settle(self) -> Any:
        """The state of rest that the timestep brings the scene to, as `hmax probe model.xml` finds it; else that of the beginning."""
        model, data = self._model, self._data
        damping = model.dof_damping.copy()

        def step(h: float) -> bool:
            model.opt.timestep = h
            self._mujoco.mj_step(model, data)
            return self._resets() == self._before

        def damp(rate: float) -> None:
            model.dof_damping[:] = damping + rate * model.dof_M0

        try:
            _core.settle(float(model.opt.timestep), step, lambda: float(np.abs(data.qvel).max()), damp, self._put_back)
        finally:
            damp(0)
        return self.state()

    def _put_back(self) -> None:
        self._mujoco.mj_copyData(self._data, self._model, self._begin)
        self._before = self._resets()

    def _resets(self) -> int:
        warnings = self._data.warning
        return sum([warnings[kind].number for kind in self._reset_kinds])

"""Meshes, bodies of soft tissue, and advice."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping, Optional, Sequence, Union

import numpy as np

from . import _core
from ._answer import Answer, answer
from ._arguments import Matrix, count, instant, number, structure, vector
from ._runs import Run, run_settings
from ._stability import method_name

Unit = Union[str, float]


@dataclass(frozen=True, eq=False)
class Mesh:
    """A tetrahedral mesh."""

    name: str
    """The name or the file that it was asked for by."""
    unit: Optional[float]
    """Metres in one unit of its file; None of meshes by name."""
    points: Any
    """Positions at rest [m], shape (points, 3)."""
    point_numbers: Any
    """Of each point the number in the file, or from 1 in a mesh by name, as `supports` takes it, shape (points)."""
    tetrahedra: Any
    """Four points each, from 0, shape (tetrahedra, 4)."""
    regions: Any
    """Of each tetrahedron the region, by the number in the file; 0 where it has none; shape (tetrahedra)."""


def read_mesh(path: Any, unit: Optional[Unit] = None) -> Mesh:
    """A mesh by name, such as "liver" or "ball:n=6", or from a file, as `hmax mesh` takes it.

    Parameters
    ----------
    path : a name, or a file: Gmsh, VTK, TetGen, Medit, Vega
    unit : of a file, which does not say it: "m", "cm", "mm" or a number of metres

    The points of a file, and of a mesh by name from 5000 tetrahedra on, are renumbered for locality. Points of a file at exactly
    the same place are merged, unless ":merge=off" stands behind it. Defects are refused. The arrays are read only: a Body reads the
    mesh by its name again.

    Raises ValueError with file, line and remedy.

    >>> import hmax
    >>> mesh = hmax.read_mesh("liver")
    >>> mesh.points.shape, mesh.tetrahedra.shape
    ((299, 3), (1151, 4))
    """
    metres = _metres(unit)
    name, *arrays = _core.read_mesh(str(path), metres)
    for array in arrays:
        array.setflags(write=False)
    return Mesh(name, metres, *arrays)


class Body:
    """Soft tissue on a mesh, M q'' = F(q, v): displacements q and velocities v of the points that are free to move.

    Parameters
    ----------
    mesh : a Mesh, or what read_mesh() takes
    model : "fem_green" (default), "fem_cauchy", "fem_corotational", "fem_neo_hookean",
        "fem_nodal_pressure", "fem_quadratic" or "mass_spring"
    material : such as "liver:male_normal"; see `hmax list materials`
    load : such as "gravity" or "press"
    unit : of a mesh file, as of read_mesh()
    gravity : [m/s2], shape (3)
    supports : sets of points that are fixed, as `--support` of the program takes them
    parameters : others by name, such as E [Pa], nu, rho [kg/m3], alpha [1/s], beta [s]; see docs/reference/tissue.md

    Raises ValueError for unknown names, and for numbers that make no body.

    >>> import hmax
    >>> body = hmax.Body("liver", "fem_corotational", E=5500, alpha=0, beta=0)
    >>> limit = hmax.largest_stable_step("symplectic_euler", body.K(), body.M(), body.C())
    >>> print(f"{body.dofs} unknowns, h_max = {1000 * limit.h_max:.2f} ms")
    849 unknowns, h_max = 2.28 ms
    """

    def __init__(
        self,
        mesh: Union[Mesh, Any],
        model: str = "",
        material: str = "",
        load: str = "",
        unit: Optional[Unit] = None,
        gravity: Optional[Sequence[float]] = None,
        supports: Sequence[str] = (),
        **parameters: float,
    ) -> None:
        name, metres = (mesh.name, mesh.unit) if isinstance(mesh, Mesh) else (str(mesh), _metres(unit))
        own = 1.0 if metres is None else metres
        if unit is not None and isinstance(mesh, Mesh) and own != _metres(unit):
            raise ValueError(f"unit is {unit!r} but the mesh was read in units of {own} m; leave it out")
        down = None if gravity is None else vector("gravity", gravity)
        if down is not None and len(down) != 3:
            raise ValueError(f"gravity has {len(down)} numbers but is a vector of three, such as (0, -9.81, 0)")
        for given in parameters.keys() & {"gx", "gy", "gz"} if down is not None else ():
            raise ValueError(f"gravity and {given} say the same; give one of them")
        if not isinstance(supports, (str, list, tuple)):
            raise ValueError(f"supports is {supports!r} but must be a list of sets of points, such as ['surface:30']")
        sets = [supports] if isinstance(supports, str) else [str(each) for each in supports]
        self._core = _core.Body(name, str(model), str(material), str(load), _values(parameters), down, sets, metres)

    @property
    def id(self) -> str:
        """MODEL@MESH, as --problem of the program takes it."""
        return str(self._core.id)

    @property
    def dofs(self) -> int:
        """Numbers of q."""
        return int(self._core.dofs)

    @property
    def points(self) -> Any:
        """Positions at rest [m], shape (points, 3): those of its mesh, with the middles of edges of "fem_quadratic"."""
        return self._core.points

    @property
    def free_points(self) -> Any:
        """Which of `points` q moves, three numbers each, in its order, shape (dofs / 3)."""
        return self._core.free_points

    def K(self, q: Any = None, v: Any = None, t: float = 0) -> Any:
        """Stiffness -dF/dq [N/m] at displacements q and velocities v, at rest by default, sparse of shape (dofs, dofs)."""
        return self._core.K(_state(q, "q"), _state(v, "v"), instant(t))

    def M(self) -> Any:
        """Lumped masses [kg], sparse of shape (dofs, dofs)."""
        return self._core.M()

    def C(self, q: Any = None, v: Any = None, t: float = 0) -> Any:
        """Damping -dF/dv [N s/m], as K()."""
        return self._core.C(_state(q, "q"), _state(v, "v"), instant(t))

    def force(self, q: Any = None, v: Any = None, t: float = 0) -> Any:
        """F(t, q, v) [N], shape (dofs)."""
        return self._core.force(_state(q, "q"), _state(v, "v"), instant(t))

    def integrate(
        self,
        method: str,
        t_end: float,
        h: Optional[float] = None,
        rtol: Optional[float] = None,
        atol: Optional[float] = None,
        q0: Any = None,
        v0: Any = None,
        every: Optional[float] = None,
    ) -> Run:
        """The motion of the body, as integrate(): states are q, then v; at rest at the start by default."""
        parts = [np.zeros(self.dofs) if given is None else vector(name, given) for name, given in (("q0", q0), ("v0", v0))]
        for name, part in zip(("q0", "v0"), parts):
            if len(part) != self.dofs:
                raise ValueError(f"{name} has {len(part)} numbers but must have {self.dofs}, those of q")
        settings = run_settings(t_end, h, rtol, atol, every)
        return Run(**self._core.run(method_name(method), np.concatenate(parts), *settings))


def advise(
    model: Union[Body, str, None] = None,
    rate: Optional[float] = None,
    tolerance: Optional[float] = None,
    budget: Optional[float] = None,
    methods: Sequence[str] = (),
    frames: int = 1000,
    material: str = "",
    y0: Optional[Sequence[float]] = None,
    K: Optional[Matrix] = None,
    M: Optional[Matrix] = None,
    C: Optional[Matrix] = None,
    t_end: Optional[float] = None,
    within: Optional[float] = 60,
    **parameters: float,
) -> Answer:
    """Which integrator, and how large a step, for a model and a frame rate, as `hmax advise --json`.

    It takes some seconds to `within`: candidates are run and timed.

    Parameters
    ----------
    model : a Body, or what --problem of the program takes: the id of a problem, or a file of formulas
    rate : frames a second [Hz]
    tolerance : largest error of the motion, relative to the largest displacement of a body, or to the range of each state; 0.01 by
        default
    budget : CPU time of a frame [ms]; given without tolerance, methods are ranked by error; the whole frame by default
    methods : to choose from; by default those that simulators use
    frames : number of frames that the best methods are timed for
    within : elapsed time of the answer [s], which is what is known by then; None: no limit
    material, y0, parameters : of a problem by id, as of `hmax list problems`
    K, M, C : as of largest_stable_step(), instead of a model; their motion is that from y0 to t_end
    t_end : of matrices [s]; 1 by default

    `recommended` is a row of `rows`, or None; then `remedies` says what would help.

    Raises ValueError for input that is wrong.

    >>> import hmax
    >>> advice = hmax.advise("liver_forced", rate=100, methods=["rk4"], frames=50)
    >>> print(advice.recommended.method, advice.recommended.verdict, advice.recommended.bound)
    rk4 recommended rate
    """
    hertz = between("rate", rate, 1, 1e5)
    allowed = 0.01 if tolerance is None else between("tolerance", tolerance, 1e-10, 1)
    milliseconds = None if budget is None else min(between("budget", budget, 1e-6, 1050 / hertz), 1000 / hertz)
    names = [methods] if isinstance(methods, str) else [method_name(method) for method in methods]
    seconds = float("inf") if within is None else between("within", within, 1e-3, 1e9)
    question = (hertz, allowed, milliseconds, budget is not None and tolerance is None, names, min(count("frames", frames), 10**6), seconds)
    if model is None:
        for given in [*parameters, *(["material"] if material else [])]:
            raise ValueError(f"{given} is of a model, and matrices are given; leave it out")
        matrices, end = structure(K, M, C, "a model"), between("t_end", 1 if t_end is None else t_end, 1e-9, 1e9)
        if y0 is None:
            raise ValueError("y0 is missing; give the displacements and velocities that the motion begins with")
        return answer(_core.Model.of_matrices(*matrices, vector("y0", y0), end).advise(*question))
    if K is not None or M is not None or C is not None:
        raise ValueError("a model and matrices are both given; give one of them")
    if t_end is not None:
        raise ValueError("t_end is of matrices, and a model is given, which has its own; leave it out")
    return answer(core_model(model, material, y0, parameters).advise(*question))


def predict(
    model: Union[Body, str],
    methods: Union[str, Sequence[str]],
    at: str = "equilibrium",
    along: str = "",
    verify: bool = False,
    t_end: Optional[float] = None,
    material: str = "",
    y0: Optional[Sequence[float]] = None,
    **parameters: float,
) -> Answer:
    """The largest stable step of methods on a model, and the mode that limits it, as `hmax stability predict --json`.

    Parameters
    ----------
    model : a Body, or what --problem of the program takes: the id of a problem, or a file of formulas
    methods : ids, aliases or families of methods(), or "all"
    at : of a Body: "equilibrium" under its load, or "rest", without displacement
    along : also the smallest limit along the "motion" from the initial state, or of a Body while its "load" grows; "none": of the
        state alone; by default the motion where the limits of one state do not tell of it
    verify : also integrate on both sides of each limit
    t_end : end of that motion [s]; the problem's own, and at least a period of its load, by default
    material, y0, parameters : of a problem by id, as of `hmax list problems`

    Each of `rows` has `h_max` [s], `bound`, `limiting`, and what was asked for; `models` has the facts of the model, and `left_out` says
    which methods of a family the model does not suit.

    Raises ValueError for input that is wrong.

    >>> import hmax
    >>> answer = hmax.predict(hmax.Body("cube:n=2", load="gravity"), ["rk4"])
    >>> print(answer.rows[0].bound, answer.rows[0].state_kind)
    stability equilibrium
    """
    names = [methods] if isinstance(methods, str) else [method_name(method) for method in methods]
    for name, given, known in (("at", at, ("equilibrium", "rest")), ("along", along, ("", "motion", "load", "none"))):
        if given not in known:
            raise ValueError(f"{name} is {given!r} but must be one of {', '.join(repr(each) for each in known if each)}")
    question = (names, at, along, bool(verify), None if t_end is None else number("t_end", t_end))
    return answer(core_model(model, material, y0, parameters).predict(*question))


def core_model(model: Any, material: str, y0: Any, parameters: Mapping[str, Any]) -> _core.Model:
    """A Body, or a problem by id, as the extension module takes it."""
    if isinstance(model, Body):
        if material or y0 is not None or parameters:
            raise ValueError("a Body has its material and parameters already; give them to Body")
        return model._core
    if not isinstance(model, str):
        raise ValueError(f"the model is {model!r} but must be a Body or the id of a problem, such as 'liver_forced'")
    start = [] if y0 is None else vector("y0", y0).tolist()
    return _core.Model(model, str(material), _values(parameters), start)


def _state(given: Any, name: str) -> Any:
    return None if given is None else vector(name, given)


def _values(parameters: Mapping[str, Any]) -> Sequence[Any]:
    for name, value in parameters.items():
        if value is None:
            raise ValueError(f"{name} is None but must be a number; leave it out for its default")
    return [(name, number(name, value)) for name, value in parameters.items()]


def between(name: str, given: Any, least: float, most: float) -> float:
    value = number(name, given)
    if value is None or not least <= value <= most:
        raise ValueError(f"{name} is {given} but must lie between {least:g} and {most:g}")
    return value


def _metres(unit: Optional[Unit]) -> Optional[float]:
    return None if unit is None else _core.unit_in_metres(str(unit))

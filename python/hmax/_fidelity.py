"""What steps show of a material."""

from __future__ import annotations

from typing import Any, Callable, Optional, Sequence, Union

from ._answer import Answer, answer
from ._arguments import number
from ._models import Body, between, core_model
from ._probe import steps_fidelity
from ._runs import method_name


def fidelity(
    model: Union[Body, str, Callable[[Any, float], Any]],
    rate: Optional[float] = None,
    methods: Union[str, Sequence[str]] = (),
    verify: bool = False,
    ceiling: bool = False,
    enter: Optional[float] = None,
    y0: Any = None,
    h: Optional[float] = None,
    h0: Optional[float] = None,
    load: Any = None,
    material: str = "",
    **parameters: float,
) -> Answer:
    """What steps make of stiffness, damping and frequencies: of methods on a model, as `hmax fidelity --json`, or of a step function.

    Parameters
    ----------
    model : a Body under a load, what --problem of the program takes: the id of a problem, or a file of formulas, or a function
        `step(y, h)` that returns the state after a step of h [s], shape (n), n up to 300
    rate : of a model: frames a second, each one step [Hz]
    methods : of a model: with their parameters, such as "vbd:iterations=5"; those that simulators use by default
    verify : of a model: also observe runs from rest, and from each mode
    ceiling : of a Body: also the largest modulus that the steps can show
    enter : of a Body: a modulus that is to be shown [Pa]: also which one to enter for it
    y0 : of a step function: the state that it begins with, shape (n); of a problem by id instead of its own
    h : of a step function: the step size [s]
    h0 : of a step function: a small step size that stands for the model [s]; a hundredth of h by default
    load : of a step function: f, shape (n): also `stiffness_shown`, f . y(h0) / f . y(h) of the states of rest y, measured from
        where the model rests without load
    material, parameters : of a problem by id, as of `hmax list problems`

    Of a model the answer has `rows`, one for each method. Of a step function: `settles` (there is a state of rest near which nothing
    grows), `settled_moves` (|y(h) - y(h0)| / |y(h0)|), `stiffness_shown`, `modes` (`omega`, `zeta` of steps of h0 and `omega_shown`,
    `zeta_shown` of steps of h [rad/s, 1]), `grows`, `spectral_radius`, `status`. What is not found is None.

    Exceptions of the function are raised as they are. Raises ValueError for other input that is wrong.

    >>> import hmax
    >>> body = hmax.Body("cube:n=2", "fem_cauchy", load="press")
    >>> row = hmax.fidelity(body, rate=100, methods=["implicit_euler"]).rows[0]
    >>> print(f"{row.stiffness_shown:.3f}")
    1.000
    >>> def implicit_euler(y, h):  # x'' = 10 - 100 x
    ...     v = (y[1] + h * (10 - 100 * y[0])) / (1 + 100 * h * h)
    ...     return [y[0] + h * v, v]
    >>> shown = hmax.fidelity(implicit_euler, y0=[0, 0], h=0.05, h0=1e-4, load=[1, 0])
    >>> print(f"{shown.stiffness_shown:.3f}, damping ratio {shown.modes[0].zeta_shown:.2f}")
    1.000, damping ratio 0.23
    """
    of_model = {"rate": rate, "methods": methods or None, "verify": verify or None, "ceiling": ceiling or None, "enter": enter}
    of_problem = {"material": material or None, **parameters}
    of_step = {"h": h, "h0": h0, "load": load}
    if isinstance(model, Body):
        strange, kind = {"y0": y0, **of_step, **of_problem}, "a Body"
    elif isinstance(model, str):
        strange, kind = of_step, "a problem by id"
    else:
        strange, kind = {**of_model, **of_problem}, "a step function"
    for name, given in strange.items():
        if given is not None:
            raise ValueError(f"{name} does not belong to {kind}; leave it out")
    if not isinstance(model, (Body, str)):
        return steps_fidelity(model, y0, h, h0, load)
    hertz = between("rate", rate, 1e-3, 1e9)
    wanted = None if enter is None else between("enter", number("enter", enter), 1e-3, 1e15)
    names = [methods] if isinstance(methods, str) else [method_name(method) for method in methods]
    question = (hertz, names, bool(verify), bool(ceiling), wanted)
    return answer(core_model(model, material, y0, parameters).fidelity(*question))

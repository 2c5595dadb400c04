"""Which integrator, and how large a step: time step limits of your own matrices, steps and bodies.

numpy arrays and scipy.sparse matrices go in and come out. Input that is wrong is a ValueError that says what to do.
"""

from ._answer import Answer
from ._core import __version__
from ._fidelity import fidelity
from ._models import Body, Mesh, advise, predict, read_mesh
from ._mujoco import check
from ._probe import probe
from ._runs import Run, integrate
from ._stability import Limit, Modes, largest_stable_step, limits, methods, modes, region

__all__ = [
    "Answer",
    "Body",
    "Limit",
    "Mesh",
    "Modes",
    "Run",
    "__version__",
    "advise",
    "check",
    "fidelity",
    "integrate",
    "largest_stable_step",
    "limits",
    "methods",
    "modes",
    "predict",
    "probe",
    "read_mesh",
    "region",
]

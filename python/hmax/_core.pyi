from typing import Any, Dict, List, Tuple

__version__: str

def methods() -> List[Dict[str, Any]]: ...
def limits(method: str) -> Dict[str, Any]: ...
def region(method: str, cells: int) -> Dict[str, Any]: ...
def limit_of_structure(method: str, K: Any, M: Any, C: Any, verify: bool) -> Dict[str, Any]: ...
def limit_of_jacobian(method: str, J: Any, verify: bool) -> Dict[str, Any]: ...
def modes(K: Any, M: Any, C: Any, count: int, fastest: bool) -> Tuple[Any, Any, Any]: ...
def run_function(
    method: str, rhs: Any, jacobian: Any, y0: Any, t_end: Any, h: Any, rtol: Any, atol: Any, every: Any
) -> Dict[str, Any]: ...
def run_structure(
    method: str, K: Any, M: Any, C: Any, y0: Any, t_end: Any, h: Any, rtol: Any, atol: Any, every: Any
) -> Dict[str, Any]: ...
def probe(
    step: Any,
    save: Any,
    restore: Any,
    y0: Any,
    in_place: bool,
    name: str,
    single: bool,
    quaternions: Any,
    scales: Any,
    pattern: Any,
    h0: float,
    h1: float,
    motion: Any,
    verify: bool,
    own_step: Any,
) -> Dict[str, Any]: ...
def compare(step: Any, y0: Any, name: str, single: bool, h0: float, h: float, load: Any) -> Dict[str, Any]: ...
def settle(timestep: float, step: Any, speed: Any, damp: Any, begin_again: Any) -> str: ...
def read_mesh(path: str, unit: Any) -> Tuple[str, Any, Any, Any, Any]: ...
def unit_in_metres(unit: str) -> float: ...
def advise(
    id: str,
    material: str,
    parameters: Any,
    y0: Any,
    rate: float,
    tolerance: float,
    budget: Any,
    least_error: bool,
    methods: List[str],
    frames: int,
    within: float,
) -> Dict[str, Any]: ...
def advise_structure(
    K: Any,
    M: Any,
    C: Any,
    y0: Any,
    t_end: float,
    rate: float,
    tolerance: float,
    budget: Any,
    least_error: bool,
    methods: List[str],
    frames: int,
    within: float,
) -> Dict[str, Any]: ...
def fidelity(
    id: str, material: str, parameters: Any, y0: Any, rate: float, methods: List[str], verify: bool, ceiling: bool, enter: Any
) -> Dict[str, Any]: ...
def predict(
    id: str, material: str, parameters: Any, y0: Any, methods: List[str], at: str, along: str, verify: bool, t_end: Any
) -> Dict[str, Any]: ...

class Body:
    id: str
    dofs: int
    free_points: Any
    def __init__(
        self, mesh: str, model: str, material: str, load: str, parameters: Any, gravity: Any, supports: List[str], unit: Any
    ) -> None: ...
    def K(self, q: Any, v: Any, t: float) -> Any: ...
    def C(self, q: Any, v: Any, t: float) -> Any: ...
    def M(self) -> Any: ...
    def force(self, q: Any, v: Any, t: float) -> Any: ...
    def run(self, method: str, y0: Any, t_end: Any, h: Any, rtol: Any, atol: Any, every: Any) -> Dict[str, Any]: ...
    def advise(
        self, rate: float, tolerance: float, budget: Any, least_error: bool, methods: List[str], frames: int, within: float
    ) -> Dict[str, Any]: ...
    def fidelity(self, rate: float, methods: List[str], verify: bool, ceiling: bool, enter: Any) -> Dict[str, Any]: ...
    def predict(self, methods: List[str], at: str, along: str, verify: bool, t_end: Any) -> Dict[str, Any]: ...

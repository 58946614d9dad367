"""The compiled module; what people use is in the package."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypedDict, final
import enum

import numpy as np
from numpy.typing import NDArray

version: str

class _Columns(TypedDict):
    time: NDArray[np.float64]
    q: NDArray[np.float64]
    dq: NDArray[np.float64]
    theta: NDArray[np.float64]
    dtheta: NDArray[np.float64]
    tau: NDArray[np.float64]

class _Result(TypedDict):
    code: int
    name: str
    sentence: str
    link_error: tuple[float, float]
    link_error_rms: tuple[float, float]
    final_link_error: tuple[float, float]
    residual_vibration: tuple[float, float]
    feedback_torque: tuple[float, float]
    log_file: str

class _Simulated(_Columns):
    completed: bool
    failure: str

@final
class Progress:
    """What a search is doing."""
    @property
    def stage(self) -> str:
        """What is being solved, in words."""
    @property
    def iteration(self) -> int:
        """Of the optimiser, over the whole plan."""
    @property
    def objective(self) -> float: ...
    @property
    def violation(self) -> float:
        """Of the constraints, scaled."""
    @property
    def phase(self) -> str:
        """``finding``, ``refining``, ``margins``, ``explaining`` or ``damping``."""

class Control(enum.Enum):
    OPEN_LOOP = 0
    CLOSED_LOOP = 1
    EXECUTOR = 2

@final
class Robot:
    @staticmethod
    def load(file: Path, /) -> Robot: ...
    @staticmethod
    def from_json(text: str, /) -> Robot: ...
    @staticmethod
    def shipped_file() -> Path: ...
    def to_json(self) -> str: ...
    @property
    def source(self) -> str: ...
    @property
    def hash(self) -> str: ...
    @property
    def doubts(self) -> list[str]: ...

@final
class Plan:
    @staticmethod
    def load(folder: Path) -> Plan: ...
    @property
    def time(self) -> NDArray[np.float64]: ...
    @property
    def q(self) -> NDArray[np.float64]: ...
    @property
    def dq(self) -> NDArray[np.float64]: ...
    @property
    def theta(self) -> NDArray[np.float64]: ...
    @property
    def dtheta(self) -> NDArray[np.float64]: ...
    @property
    def tau(self) -> NDArray[np.float64]: ...
    @property
    def robot(self) -> Robot: ...
    @property
    def ends_at_rest(self) -> bool: ...
    def to_json(self) -> str: ...
    def interpolate(self, times: NDArray[np.float64]) -> _Columns: ...
    def mean_torque(self, tick: float) -> NDArray[np.float64]: ...
    def save(self, folder: Path, report: bool, keep_uncertified: bool) -> list[str]: ...
    def page(self) -> str: ...
    def verify(self, robot: Robot, payload: tuple[float, float] | None, proven: bool) -> str: ...
    def verify_request(
        self, text: str | None, source: str, folder: Path, robot: Robot | None, proven: bool
    ) -> str: ...
    def simulate(self, arm: Robot | None, control: Control, hold: float) -> _Simulated: ...

def plan(
    text: str | None,
    source: str,
    folder: Path,
    robot: Robot | None,
    warm: Plan | None,
    jobs: int,
    deadline: float,
    starts: int,
    linear_solver: str,
    proven: bool,
    progress: Callable[[Progress], Any] | None,
) -> Plan: ...
def value_at(text: str | None, source: str, field: str) -> str | None: ...
def keys() -> list[tuple[str, str, str, str, str]]: ...
def verify_file(path: Path, robot: Robot, payload: tuple[float, float] | None, proven: bool) -> str: ...
def verify_file_request(
    path: Path, text: str | None, source: str, folder: Path, robot: Robot | None, proven: bool
) -> str: ...

procedures: tuple[str, ...]

@final
class Estimate:
    @property
    def procedure(self) -> str: ...
    @property
    def joint(self) -> int: ...
    @property
    def log(self) -> str: ...
    @property
    def sha256(self) -> str: ...
    @property
    def parameters(self) -> list[tuple[str, float, str, float, bool]]: ...
    @property
    def covariance(self) -> list[list[float]]: ...
    @property
    def points(self) -> int: ...
    @property
    def residual_rms(self) -> float: ...
    @property
    def residual_unit(self) -> str: ...
    @property
    def r_squared(self) -> float: ...
    @property
    def warnings(self) -> list[str]: ...

@final
class Identification:
    @property
    def estimates(self) -> list[Estimate]: ...
    @property
    def warnings(self) -> list[str]: ...
    def refuse_contradictions(self, source: str) -> None: ...
    def write(self, file: Path, base: Path, link_damping: bool) -> Robot: ...
    def report(self) -> str: ...

def identify(name: str, logs: list[str], joint: int, columns: dict[str, str], base: Path) -> Identification: ...

@final
class ServiceProgress:
    """Where a request is with the service."""
    @property
    def queue_position(self) -> int:
        """0: it is being solved."""
    @property
    def progress(self) -> Progress: ...
    @property
    def elapsed(self) -> float:
        """Since arrival [s]."""

@final
class ExecutionProgress:
    """Where the arm is."""
    @property
    def time(self) -> float:
        """Within the trajectory [s]."""
    @property
    def duration(self) -> float:
        """Of the trajectory [s]."""
    @property
    def link_error(self) -> list[float]:
        """Of both links, by their encoders [rad]."""

@final
class Answered:
    @property
    def id(self) -> str: ...
    @property
    def plan(self) -> Plan | None: ...
    @property
    def state(self) -> str: ...
    @property
    def bad_input(self) -> bool: ...
    @property
    def field(self) -> str: ...
    @property
    def sentence(self) -> str: ...
    @property
    def solve_time(self) -> float: ...
    @property
    def wait_time(self) -> float: ...
    @property
    def result(self) -> _Result | None: ...

@final
class Connection:
    def __init__(
        self, domain: int, security: Path | None, allow_insecure_network: bool, find: float, silence: float
    ) -> None: ...
    def request(
        self,
        name: str,
        document: str,
        execute: bool,
        robot_id: str,
        robot_hash: str,
        priority: int,
        budget: float,
        listener: Callable[[Any], Any],
    ) -> Answered: ...
    def execute(self, id: str, repeat: bool, robot_id: str, listener: Callable[[Any], Any]) -> Answered: ...
    def overview(self, wait: float) -> tuple[list[dict[str, Any]], list[dict[str, Any]], str | None]: ...

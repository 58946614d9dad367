"""The problems, from the same request files that fjr plans; a mesh and a minimum-jerk guess for each."""
import dataclasses
import pathlib

import numpy as np
import yaml

from files import ROOT

HERE = pathlib.Path(__file__).resolve().parent
REQUESTS = {
    "effort": ROOT / "config/requests/efficient_reach.yaml",
    "effort reversal": HERE / "requests/effort_reversal.yaml",
    "via": ROOT / "config/requests/via_points.yaml",
    "fastest reach": ROOT / "config/requests/reach.yaml",
    "fastest swing": HERE / "requests/fastest_swing.yaml",
    "fastest upright": HERE / "requests/fastest_upright.yaml",
}
PRESETS = {"fastest": {"time": 1.0}, "efficient": {"effort": 1.0}, "gentle": {"link_acceleration": 1e-3, "effort": 0.01}}


@dataclasses.dataclass
class Via:
    time: float
    q: np.ndarray
    dq: np.ndarray | None


@dataclasses.dataclass
class Guess:
    times: np.ndarray    # [s]
    columns: np.ndarray  # (n, 10): x and u at them

    @property
    def duration(self):
        return self.times[-1]

    def at(self, nodes):
        """x and u at nodes in [0, 1], linear between what is known."""
        table = np.array([np.interp(nodes * self.duration, self.times, column) for column in self.columns.T]).T
        return table[:, :8], table[:, 8:]


@dataclasses.dataclass
class Problem:
    """From rest to rest. Minimises weights: time T, effort = int tau_m^2, link_acceleration = int ddq^2."""
    name: str
    request: pathlib.Path
    start: np.ndarray
    goal: np.ndarray
    duration: float | None  # None: free
    via: list[Via]
    weights: dict[str, float]

    @property
    def free(self):
        return self.duration is None

    def mesh(self, intervals):
        """Nodes in [0, 1], with one at each via time, and the node of each via point."""
        if not self.via:
            return np.linspace(0, 1, intervals + 1), []
        corners = np.array([0, *(v.time for v in self.via), self.duration]) / self.duration
        counts = np.maximum(1, np.round(np.diff(corners) * intervals).astype(int))
        pieces = [np.linspace(a, b, n + 1)[1:] for a, b, n in zip(corners, corners[1:], counts)]
        return np.concatenate([[0.0], *pieces]), list(np.cumsum(counts)[:-1])

    def minimum_jerk(self, arm):
        """Quintics in q through the points, motors by flatness. A free duration is that in which such a motion takes
        motors to 0.7 of their velocity limits."""
        fastest = 1.875 * np.abs(self.goal - self.start) / (0.7 * arm.limits["motor_velocity"])
        duration = self.duration or max(0.2, np.max(fastest))
        times = np.linspace(0, duration, 2001)
        q, dq, ddq = self._quintics(times)
        spring = np.array([np.array(arm.inverse(*row)).ravel() for row in zip(q, dq, ddq)])
        theta = q + spring / arm.p["spring.stiffness"]
        dtheta = np.gradient(theta, times, axis=0)
        u = spring + arm.p["friction.viscous"] * dtheta + arm.p["motor.inertia"] * np.gradient(dtheta, times, axis=0)
        return Guess(times, np.hstack([q, dq, theta, dtheta, np.clip(u, -arm.limits["torque"], arm.limits["torque"])]))

    def _quintics(self, times):
        """Rest at both ends; at via points no acceleration, and the velocity asked for or that of the way past them."""
        t = np.array([0, *(v.time for v in self.via), times[-1]])
        q = np.array([self.start, *(v.q for v in self.via), self.goal])
        dq = np.zeros_like(q)
        for i, v in enumerate(self.via, 1):
            dq[i] = v.dq if v.dq is not None else (q[i + 1] - q[i - 1]) / (t[i + 1] - t[i - 1])
        piece = np.clip(np.searchsorted(t, times, side="right") - 1, 0, len(t) - 2)
        h = (t[piece + 1] - t[piece])[:, None]
        s = (times[:, None] - t[piece][:, None]) / h
        step, a, b = q[piece + 1] - q[piece], h * dq[piece], h * dq[piece + 1]
        c3, c4, c5 = 10 * step - 6 * a - 4 * b, -15 * step + 8 * a + 7 * b, 6 * step - 3 * a - 3 * b
        return (q[piece] + a * s + c3 * s**3 + c4 * s**4 + c5 * s**5,
                (a + 3 * c3 * s**2 + 4 * c4 * s**3 + 5 * c5 * s**4) / h,
                (6 * c3 * s + 12 * c4 * s**2 + 20 * c5 * s**3) / h**2)


def read(name):
    """What the peers are not taught (obstacles, limits of a request, moving starts, ...) is refused, not passed over."""
    path = REQUESTS[name]
    request = yaml.safe_load(path.read_text())
    allowed = {"start", "goal", "duration", "objective", "via"}
    for key in request.keys() - allowed:
        raise ValueError(f"{path}: {key}: allowed are {', '.join(sorted(allowed))}")
    for end in ("start", "goal"):
        if request[end].keys() != {"q"}:
            raise ValueError(f"{path}: {end}: found {request[end]}, allowed is q alone, at rest")
    objective, duration = request.get("objective", "fastest"), request.get("duration", "free")
    weights = PRESETS[objective] if isinstance(objective, str) else objective
    if not weights.keys() <= {"time", "effort", "link_acceleration"}:
        raise ValueError(f"{path}: objective: found {weights}, allowed are time, effort and link_acceleration")
    via = [Via(v["time"], np.array(v["q"], float), np.array(v["dq"], float) if "dq" in v else None)
           for v in request.get("via", [])]
    return Problem(name, path, np.array(request["start"]["q"], float), np.array(request["goal"]["q"], float),
                   None if duration == "free" else float(duration), via, dict(weights))

"""The arm as CasADi functions: the only place of bench/peers with its equations. Numbers come from robot.yaml.

    M(q) ddq + C(q,dq) dq + D dq + G(q) = tau_c,   tau_c = K (theta - q)
    J ddtheta + B dtheta + tau_c = u,              tau_m = u + friction(dtheta)

State x = (q, dq, theta, dtheta), control u: the friction-compensated torque of the paper's (26). Friction, (24) less its
viscous part, appears in tau_m alone, so that the dynamics of the peers are smooth.
"""
import casadi as ca
import numpy as np

from files import ROBOT, parameters

STATES, CONTROLS = 8, 2


def smoothed(width, shape, eps):
    """Width eta and shape h of (24) without features narrower than eps [rad/s]: FrictionLaw::smoothed of model/friction.h."""
    if eps <= 0:
        return width, shape
    wide = np.hypot(width, eps)
    if shape < 1:
        return wide, min(0.0, 1 - wide / np.hypot(width / (1 - shape), eps))
    return wide, shape * width / wide


class Arm:
    """f(x, u) = dx/dt, torque(x, u) = tau_m with friction smoothed by eps [rad/s], exact_torque(x, u) with that of (24),
    acceleration(x) = ddq, inverse(q, dq, ddq) = tau_c."""

    def __init__(self, eps, robot=ROBOT):
        self.p = p = parameters(robot)
        self.eps = eps
        self.limits = {name: p[f"limits.{name}"] for name in ("torque", "motor_velocity", "link_position", "spring_deflection")}
        l, m = p["link.length"], p["link.mass"]
        r2 = p["link.com_fraction"][1] * l[1]
        self._about_joint2 = p["link.inertia"][1] + m[1] * r2**2
        self._coupling = r2 * m[1] * l[0]
        self._m11 = p["link.inertia"][0] + self._about_joint2 + m[1] * l[0]**2

        x, u = ca.SX.sym("x", STATES), ca.SX.sym("u", CONTROLS)
        q, dq, theta, dtheta = ca.vertsplit(x, 2)
        spring = p["spring.stiffness"] * (theta - q)
        ddq = ca.solve(self._mass(q), spring - self._bias(q, dq))
        ddtheta = (u - spring - p["friction.viscous"] * dtheta) / p["motor.inertia"]
        self.f = ca.Function("f", [x, u], [ca.vertcat(dq, ddq, dtheta, ddtheta)])
        self.acceleration = ca.Function("acceleration", [x], [ddq])
        self.torque = ca.Function("torque", [x, u], [u + self._friction(dtheta, eps)])
        self.exact_torque = ca.Function("exact_torque", [x, u], [u + self._friction(dtheta, 0)])
        q, dq, ddq = (ca.SX.sym(name, 2) for name in ("q", "dq", "ddq"))
        self.inverse = ca.Function("inverse", [q, dq, ddq], [self._mass(q) @ ddq + self._bias(q, dq)])

    def _mass(self, q):
        m12 = self._about_joint2 + self._coupling * ca.cos(q[1])
        m11 = self._m11 + 2 * self._coupling * ca.cos(q[1])
        return ca.vertcat(ca.horzcat(m11, m12), ca.horzcat(m12, self._about_joint2))

    def _bias(self, q, dq):
        """C(q,dq) dq + D dq + G(q), with the Lagrangian's C."""
        a = self._coupling * ca.sin(q[1])
        g1, g2 = self.p["link.gravity_torque"]
        second = g2 * ca.sin(q[0] + q[1])
        return ca.vertcat(-a * dq[1] * (2 * dq[0] + dq[1]) + g1 * ca.sin(q[0]) + second, a * dq[0]**2 + second) \
            + self.p["link.damping"] * dq

    def _friction(self, v, eps):
        p = self.p
        torque = []
        for j in range(2):
            f, omega = p["friction.amplitude"][j], p["friction.second_weight"][j]
            eta, h = smoothed(p["friction.width"][j], p["friction.second_shape"][j], eps)
            first = ca.tanh(v[j] / eta)
            torque.append(f * first - f * omega * ca.tanh(v[j] / eta - h * first))
        return ca.vertcat(*torque)

    def rest(self, q):
        """The state at rest at q."""
        hold = np.array(self.inverse(q, [0, 0], [0, 0])).ravel()
        return np.concatenate([q, [0, 0], q + hold / self.p["spring.stiffness"], [0, 0]])

    def step(self, substeps=1):
        """(x, u, h) -> the state after h under constant u, by `substeps` steps of Runge and Kutta's method of order 4."""
        x, u, h = ca.SX.sym("x", STATES), ca.SX.sym("u", CONTROLS), ca.SX.sym("h")
        y, d = x, h / substeps
        for _ in range(substeps):
            k1 = self.f(y, u)
            k2 = self.f(y + d / 2 * k1, u)
            k3 = self.f(y + d / 2 * k2, u)
            k4 = self.f(y + d * k3, u)
            y = y + d / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        return ca.Function("step", [x, u, h], [y])

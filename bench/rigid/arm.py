"""The arm with rigid gears, as planners for rigid arms know it, and what its drive is given for one of their motions.

    (M(q) + J) ddq + C(q,dq) dq + D dq + G(q) + friction(dq) = tau_m,     spring torque = tau_m less that of the motors

q, dq and ddq are (n, 2); the paper's numbers come from robot.yaml.
"""
import numpy as np

from files import ROBOT, parameters


class RigidArm:
    def __init__(self, robot=ROBOT):
        self.p = p = parameters(robot)
        self.limits = {name: p[f"limits.{name}"] for name in ("torque", "motor_velocity", "spring_deflection")}
        self.spring_torque_limit = p["spring.stiffness"] * self.limits["spring_deflection"]
        l, m = p["link.length"], p["link.mass"]
        r2 = p["link.com_fraction"][1] * l[1]
        self._about_joint2 = p["link.inertia"][1] + m[1] * r2**2
        self._coupling = r2 * m[1] * l[0]
        self._m11 = p["link.inertia"][0] + self._about_joint2 + m[1] * l[0]**2

    def mass(self, q):
        """(n, 2, 2) of the links."""
        c = self._coupling * np.cos(q[:, 1])
        m12 = self._about_joint2 + c
        return np.stack([np.stack([self._m11 + 2 * c, m12], 1), np.stack([m12, np.full_like(c, self._about_joint2)], 1)], 1)

    def gravity(self, q):
        g1, g2 = self.p["link.gravity_torque"]
        second = g2 * np.sin(q[:, 0] + q[:, 1])
        return np.stack([g1 * np.sin(q[:, 0]) + second, second], 1)

    def spring_torque(self, q, dq, ddq):
        """What the gears pass on to the links."""
        a = self._coupling * np.sin(q[:, 1])
        coriolis = np.stack([-a * dq[:, 1] * (2 * dq[:, 0] + dq[:, 1]), a * dq[:, 0]**2], 1)
        return np.einsum("nij,nj->ni", self.mass(q), ddq) + coriolis + self.p["link.damping"] * dq + self.gravity(q)

    def friction(self, v):
        """The paper's (24), with its viscous part."""
        p = self.p
        first = np.tanh(v / p["friction.width"])
        second = np.tanh(v / p["friction.width"] - p["friction.second_shape"] * first)
        return p["friction.viscous"] * v + p["friction.amplitude"] * (first - p["friction.second_weight"] * second)

    def torque(self, q, dq, ddq):
        """Of the motors."""
        return self.spring_torque(q, dq, ddq) + self.p["motor.inertia"] * ddq + self.friction(dq)

    def load(self, q, dq, ddq):
        """The largest fraction of a torque limit, of motors or springs: above 1 the motion breaks one."""
        motors = np.abs(self.torque(q, dq, ddq)) / self.limits["torque"]
        springs = np.abs(self.spring_torque(q, dq, ddq)) / self.spring_torque_limit
        return max(motors.max(), springs.max())

    def rows(self, times, q, dq, ddq):
        """(n, 11) as in trajectory.csv: what the executor is given. Motors are planned where the springs hold the links
        against gravity, so that the motion begins and ends in the true rest; the rest of the springs' work is what a
        rigid arm does not have. Motor torque is that of the rigid arm, gravity and the exact friction law included."""
        g1, g2 = self.p["link.gravity_torque"]
        together = g2 * np.cos(q[:, 0] + q[:, 1]) * (dq[:, 0] + dq[:, 1])
        gravity_rate = np.stack([g1 * np.cos(q[:, 0]) * dq[:, 0] + together, together], 1)
        stiffness = self.p["spring.stiffness"]
        theta, dtheta = q + self.gravity(q) / stiffness, dq + gravity_rate / stiffness
        torque = self.spring_torque(q, dq, ddq) + self.p["motor.inertia"] * ddq + self.friction(dtheta)
        return np.column_stack([times, q, dq, theta, dtheta, torque])

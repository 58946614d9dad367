"""The arm's equations a second time, another way: Euler and Lagrange's from the energies, with complex steps in NumPy.

Shares nothing with arm.py but the numbers of robot.yaml. `python check.py` prints the largest difference.
"""
import sys

import numpy as np

import arm as peers_arm

TOLERANCE = 1e-9  # relative to 1 + |value|; double precision leaves about 1e-12
STEP = 1e-30      # of complex steps, which have no cancellation


def kinetic_energy(p, q, dq):
    """Of the links, from the velocity of link 2's centre of mass."""
    l1, r2 = p["link.length"][0], p["link.com_fraction"][1] * p["link.length"][1]
    both, rate = q[0] + q[1], dq[0] + dq[1]
    vx = l1 * np.cos(q[0]) * dq[0] + r2 * np.cos(both) * rate
    vy = l1 * np.sin(q[0]) * dq[0] + r2 * np.sin(both) * rate
    i1, i2 = p["link.inertia"]
    return 0.5 * (i1 * dq[0]**2 + i2 * rate**2 + p["link.mass"][1] * (vx**2 + vy**2))


def potential_energy(p, q, theta):
    g1, g2 = p["link.gravity_torque"]
    stretch = theta - q
    return -g1 * np.cos(q[0]) - g2 * np.cos(q[0] + q[1]) + 0.5 * np.sum(p["spring.stiffness"] * stretch * stretch)


def along(function, point, direction):
    """Derivative of an analytic function along a direction."""
    return np.imag(function(point + 1j * STEP * direction)) / STEP


def derivative(p, x, tau):
    """dx/dt under the motor torque tau, with the exact friction of (24)."""
    q, dq, theta, dtheta = x.reshape(4, 2)
    unit = np.eye(2)

    def momentum(at):  # kinetic energy is quadratic in dq: its differences are exact
        return np.array([0.5 * (kinetic_energy(p, at, dq + e) - kinetic_energy(p, at, dq - e)) for e in unit])

    mass = np.array([[0.5 * (kinetic_energy(p, q, a + b) - kinetic_energy(p, q, a - b)) for a in unit] for b in unit])
    force = np.array([along(lambda at: kinetic_energy(p, at, dq) - potential_energy(p, at, theta), q, e) for e in unit])
    ddq = np.linalg.solve(mass, force - along(momentum, q, dq) - p["link.damping"] * dq)
    spring = np.array([along(lambda at: potential_energy(p, q, at), theta, e) for e in unit])
    s = dtheta / p["friction.width"]
    friction = p["friction.viscous"] * dtheta + p["friction.amplitude"] * (
        np.tanh(s) - p["friction.second_weight"] * np.tanh(s - p["friction.second_shape"] * np.tanh(s)))
    return np.concatenate([dq, ddq, dtheta, (tau - spring - friction) / p["motor.inertia"]])


def largest_difference(arm, states=200):
    """Over random states within the limits: arm.f under u, against this file's under u's exact torque."""
    draw = np.random.default_rng(1)
    reach = np.concatenate([arm.limits["link_position"], [8, 10], arm.limits["link_position"], arm.limits["motor_velocity"]])
    worst = 0.0
    for _ in range(states):
        x, u = draw.uniform(-1, 1, 8) * reach, draw.uniform(-1, 1, 2) * arm.limits["torque"]
        ours = np.array(arm.f(x, u)).ravel()
        theirs = derivative(arm.p, x, np.array(arm.exact_torque(x, u)).ravel())
        worst = max(worst, np.max(np.abs(ours - theirs) / (1 + np.abs(theirs))))
    return worst


def require_equal(arm):
    difference = largest_difference(arm)
    if not difference <= TOLERANCE:
        sys.exit(f"bench/peers/arm.py: differs by {difference:.2g} from the energies' equations, allowed are {TOLERANCE:g}")
    return difference


if __name__ == "__main__":
    print(f"{require_equal(peers_arm.Arm(0.05)):.2g}")

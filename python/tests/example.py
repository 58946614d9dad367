"""What a user's program looks like to mypy --strict; the tests run it too."""

from __future__ import annotations

import numpy as np

import fjr


def longest_of(goals: list[tuple[float, float]]) -> fjr.Plan:
    plans = [fjr.plan(fjr.Request(start=fjr.Start(q=(0, 0)), goal=fjr.Goal(q=goal))) for goal in goals]
    return max(plans, key=lambda plan: plan.duration)


def listen(progress: fjr.Progress) -> bool:
    return progress.iteration < 10_000


def main() -> None:
    plan = longest_of([(0.4, -0.3), (0.6, 0.2)])
    torques: np.ndarray[tuple[int, ...], np.dtype[np.float64]] = plan.mean_torque(0.001)
    print(f"{plan.name}: {plan.duration:.3f} s in {len(torques)} ticks")
    for price in plan.prices:
        print(f"{price.name} {price.joint}: 1 % more saves {price.saved_by_1_percent:.2g}")
    try:
        fjr.plan({"start": {"q": [0, 0]}, "goal": {"q": [0.4, -9]}}, progress=listen)
    except fjr.BadInput as error:
        print(error.field, error.value, error.reason)
    except fjr.NoPlan as error:
        print(error.status, error.reason, error.plan.certificate)
    run = fjr.simulate(plan, closed_loop=False)
    print(f"open loop: {run.max_link_error:.2e} rad, certified: {fjr.verify(plan).certified}")


if __name__ == "__main__":
    main()

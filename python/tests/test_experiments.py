"""Motions that tell the arm's parameters."""

from pathlib import Path

import pytest

import fjr


def test_a_design_is_a_chain_of_requests_that_can_be_planned(tmp_path: Path) -> None:
    design = fjr.design_experiment(tmp_path / "design", start=(0.2, -0.1), duration=1.2, candidates=2, payload_known=True)
    assert 0 < design.duration <= 1.2 and len(design) == len(design.requests) > 0
    first = fjr.plan(design.requests[0])
    assert first.status == "certified" and list(first.q[0]) == pytest.approx([0.2, -0.1])
    if len(design) > 1:
        assert list(fjr.plan(design.requests[1]).q[0]) == pytest.approx(list(first.q[-1]), abs=1e-12)
    assert design.standard_errors.keys() >= {"spring.stiffness[0]", "motor.inertia[1]"}
    assert all(0 < after <= before for before, after in design.standard_errors.values())
    assert design.to_dict()["motions"][0]["request"] == "01.yaml"


def test_what_there_is_stays_and_is_said(tmp_path: Path) -> None:
    (tmp_path / "mine").write_text("mine")
    with pytest.raises(fjr.BadInput, match="has files already"):
        fjr.design_experiment(tmp_path, duration=1)
    with pytest.raises(fjr.Error, match="duration"):
        fjr.design_experiment(tmp_path / "new", duration=0.5)
    assert [file.name for file in tmp_path.iterdir()] == ["mine"]

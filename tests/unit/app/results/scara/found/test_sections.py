"""Sections of single runs: figures by hand from stored steps and records."""

import math
from typing import Any, cast

import numpy as np
import pytest

from catseye.app.results.figures import Figure, Points
from catseye.app.results.model import Section, Sign, Statement, Table
from catseye.app.results.scara.arm_report import verdict
from catseye.app.results.scara.findings import Findings
from catseye.app.results.scara.found import alignment
from catseye.app.results.scara.found.error_motion import error_motion_section
from catseye.app.results.scara.found.repeatability import repeatability_section
from catseye.app.results.scara.found.sections import scara_sections
from catseye.app.results.scara.found.warmup import warmup_section
from catseye.app.store.reader import RunReader, StoredStep
from catseye.procedures.scara.radial.radial_error_motion import RadialParams
from catseye.procedures.scara.warming.warmup import WarmupParams
from tests.unit.procedures.benches import bench


class Stored:
    """A run with steps and records."""

    def __init__(
        self, procedure: str, steps: dict[str, Any], records: list[dict[str, Any]] | None = None
    ) -> None:
        params = WarmupParams(window_min=10.0, limit_um_per_10min=20.0)
        self.procedure = procedure
        self.meta = {"procedure": procedure, "params": params.model_dump(mode="json")}
        self._steps, self._records = steps, records or []

    def steps(self) -> list[StoredStep]:
        return [StoredStep(name, 1, name, "", "", 1, result, 0) for name, result in self._steps.items()]

    def result(self, step_id: str) -> Any:
        return self._steps.get(step_id)

    def records(self, kind: str) -> list[dict[str, Any]]:
        del kind
        return self._records


def read(stored: Stored) -> RunReader:
    return cast("RunReader", stored)


def table(section: Section, key: str) -> Table:
    (found,) = (block for block in section.blocks if isinstance(block, Table) and block.key == key)
    return found


def said(section: Section) -> list[Statement]:
    return [block for block in section.blocks if isinstance(block, Statement)]


def visit(k: int, segment: int, mm: float) -> dict[str, Any]:
    return {"measured": True, "segment": segment, "displacement_mm": mm, "clock_s": 120.0 * k}


def test_a_warm_up_shows_drift_and_limit() -> None:
    # 6 µm from visit to visit, two minutes apart: 30 µm in ten minutes, on a straight line.
    steps = {f"visit/{k:04d}": visit(k, 0, 0.006 * k) for k in range(8)}
    steps["visit/0008"] = {"measured": False, "segment": 0}
    steps["analyse"] = {
        "warm": False,
        "reflector": "P1",
        "drift_um_per_10min": 30.0,
        "u_drift_um_per_10min": 0.5,
        "limit_um_per_10min": 20.0,
        "elapsed_min": 16.0,
    }
    section = warmup_section(read(Stored("warmup", steps)))
    drifts = [row[3] for row in table(section, "warm-up").rows]
    assert drifts[:5] == [None] * 5
    assert drifts[5:] == pytest.approx([30.0] * 3)
    (verdict_,) = said(section)
    assert verdict_.sign is Sign.BAD
    assert verdict_.expanded == (
        "not warm after 16 min: drift in 10 min +30.0 µm, U = 1.0 µm; the limit is 20 µm"
    )
    assert "after 16 min the distance to P1 drifts by +30.0 ± 1.0 µm in 10 min (k = 2)" in verdict_.text


def test_a_new_zero_begins_the_curve_anew() -> None:
    steps = {f"visit/{k:04d}": visit(k, k // 4, 0.006 * k) for k in range(8)}
    rows = table(warmup_section(read(Stored("warmup", steps))), "warm-up").rows
    assert [row[2] for row in rows] == pytest.approx([0.0, 6.0, 12.0, 18.0] * 2)


def test_a_warm_up_that_was_stopped_is_not_called_warm() -> None:
    (verdict_,) = said(warmup_section(read(Stored("warmup", {"visit/0000": visit(0, 0, 0.0)}))))
    assert (verdict_.sign, verdict_.text) == (Sign.ATTENTION, "The run ended before the arm was warm.")


def aligned(last: float, u: float, monkeypatch: pytest.MonkeyPatch) -> Section:
    monkeypatch.setattr(alignment, "bench_of", lambda cell: cell)
    monkeypatch.setattr(alignment, "cell_of_run", lambda _reader: bench())
    rounds = [
        {"step_id": "level/1/measure", "round": 1, "value": -0.7, "u": 0.02, "instruction": ""},
        {
            "step_id": "level/2/measure",
            "round": 2,
            "value": last,
            "u": u,
            "instruction": "tilt the beam 0.70 mrad up",
        },
    ]
    height = {"j3_mm": 48.74, "u_j3_mm": 0.01}
    return alignment.alignment_section(read(Stored("beam-level", {"result": height}, rounds)))


def test_an_alignment_says_before_and_after(monkeypatch: pytest.MonkeyPatch) -> None:
    section = aligned(0.04, 0.02, monkeypatch)
    first, height = said(section)
    assert first.sign is Sign.GOOD
    assert first.text == (
        "Pitch of the beam: -0.700 mrad before, +0.040 ± 0.040 mrad (k = 2) after 1 turn of the screw; the tolerance "
        "is 0.2 mrad."
    )
    # U is twice u.
    assert first.expanded == "+0.040 mrad, U = 0.040 mrad; the tolerance is 0.2 mrad"
    assert "j3_mm = 48.74 ± 0.02 mm (k = 2)" in height.text
    assert table(section, "rounds").rows[0] == ("1", -0.7, 0.02, "–")


def test_an_alignment_counts_with_its_uncertainty(monkeypatch: pytest.MonkeyPatch) -> None:
    # 0.17 + 0.02 mrad lie within 0.2 mrad; 0.17 + 0.04 mrad, as is shown, do not.
    assert said(aligned(0.17, 0.02, monkeypatch))[0].sign is Sign.BAD
    assert said(aligned(0.15, 0.02, monkeypatch))[0].sign is Sign.GOOD


def beam(pose: int, s_um: float, p: float) -> dict[str, Any]:
    spread = {"s_um": s_um, "s_low_um": 0.7 * s_um, "s_high_um": 1.8 * s_um, "rp_um": 3.0 * s_um}
    place = {"theta1_deg": 10.0, "theta2_deg": 20.0}
    return {
        "pose": pose,
        "reflector": "P1",
        "drift_um": 1.0,
        "drift_probability": p,
        "arrivals": 9,
        **spread,
        **place,
    }


def test_repeatability_names_its_worst_pose_and_what_drifts() -> None:
    refused = {
        "pose": 2,
        "reflector": "P1",
        "refused": "no two arrivals",
        "theta1_deg": 1.0,
        "theta2_deg": 2.0,
    }
    plane = {"pose": 1, "sx_um": 3.0, "sy_um": 4.0, "rp_um": 15.0, "u_rp_um": 2.0, "assumption": "round"}
    found = {
        "beams": [beam(1, 5.0, 0.5), beam(3, 8.0, 0.001), refused],
        "positions": [plane, {"pose": 2, "refused": "parallel"}],
    }
    section = repeatability_section(read(Stored("repeatability", {"analyse": found})))
    along, across = said(section)
    assert "RP is ±24.0 µm or less: at pose 3 S = 8.0 µm" in along.text
    assert (along.sign, "1 of 2 series drift" in along.text) == (Sign.ATTENTION, True)
    assert "RP is 15.0 ± 4.0 µm (k = 2) or less: at pose 1; 1 pose without one." in across.text
    assert table(section, "beams").rows[2][4:] == (None, None, None, None, None, "no two arrivals", None)
    assert [row[-1] for row in table(section, "positions").rows] == ["round", "parallel"]


def test_drift_that_nobody_knows_is_not_ruled_out() -> None:
    two_cycles = {**beam(1, 5.0, 0.5), "drift_um": None, "drift_probability": None, "arrivals": 2}
    section = repeatability_section(
        read(Stored("repeatability", {"analyse": {"beams": [two_cycles], "positions": []}}))
    )
    (along,) = said(section)
    assert along.text.endswith("The drift is not known: measure more cycles.")
    half = {"beams": [two_cycles, beam(2, 4.0, 0.5)], "positions": []}
    (along,) = said(repeatability_section(read(Stored("repeatability", {"analyse": half}))))
    assert along.text.endswith("No series drifts, as far as that is known (1 of 2).")


def test_an_unfinished_repeatability_states_nothing_and_draws_arrivals() -> None:
    # Two zeros of the beam, each with a dead path of its own; within them 2 µm from cycle to cycle.
    arrivals = [
        {
            "reflector": "P1",
            "pose": 1,
            "cycle": k + 1,
            "segment": k // 3,
            "displacement_mm": 0.002 * k + 5.0 * (k // 3),
        }
        for k in range(6)
    ]
    section = repeatability_section(read(Stored("repeatability", {}, arrivals)))
    (only,) = said(section)
    assert "ended before its cycles were complete" in only.text
    (figure,) = (block for block in section.blocks if isinstance(block, Figure))
    ((panel,),) = figure.rows
    assert panel is not None
    (series,) = panel.marks
    assert isinstance(series, Points)
    assert series.y == pytest.approx([-2.0, 0.0, 2.0] * 2)


@pytest.mark.parametrize("procedure", ["open-loop", "tracker-warmup", "resolution"])
def test_runs_of_other_procedures_have_no_section(procedure: str) -> None:
    # A warm-up before a tracker has visits of its own.
    visits = {"visit/0000": {"clock_s": 0.0, "place_mm": [0.0, 0.0, 0.0]}}
    assert scara_sections(read(Stored(procedure, visits))) == []


def test_what_was_found_stands_for_the_verdict() -> None:
    found = warmup_section(read(Stored("warmup", {"visit/0000": visit(0, 0, 0.0)})))
    assert verdict(Findings(found=[found])) == []
    assert [one.sign for one in verdict(Findings())] == [Sign.BAD]


class StoredMotion(Stored):
    """A run that has had an artefact read, by x alone, as far as its last cycle."""

    def __init__(self, cycles: int, steps: dict[str, Any], **params: object) -> None:
        super().__init__("radial-error-motion", steps)
        given = RadialParams.model_validate({"joints": ["J1"], "directions": "x", **params})
        self.meta["params"] = given.model_dump(mode="json")
        # 3 µm in the second harmonic, 10 µm off the axis, over a whole turn.
        self._readings = [
            {
                "joint": "J1",
                "mounting": "direct",
                "direction": "x",
                "approach": approach,
                "cycle": cycle,
                "zero": cycle,
                "angle_deg": 30.0 * k,
                "reading_um": 3.0 * math.cos(math.radians(60.0 * k))
                + 10.0 * math.cos(math.radians(30.0 * k)),
            }
            for cycle in range(cycles)
            for approach in (1, -1)
            for k in range(12)
        ]

    def rows(self, name: str) -> list[dict[str, Any]]:
        del name
        return self._readings


def motion(rms_um: float, u_um: float) -> dict[str, Any]:
    values = {"total_um": 9.0, "average_um": 8.0, "asynchronous_um": 1.5, "reversal_um": 0.4}
    return {
        "joint": "J1",
        "from_deg": -140.0,
        "to_deg": 140.0,
        "rms_um": rms_um,
        "u_rms_um": u_um,
        "expanded_average_um": 1.0,
        "scatter_um": 0.6,
        "eccentricity_um": [12.0],
        "form_um": None,
        "values": [{"direction": "x", **values}],
    }


def test_an_error_motion_is_stated_with_two_u() -> None:
    section = error_motion_section(read(StoredMotion(2, {"J1/result": motion(3.456, 0.123)})))
    first, *others = said(section)
    assert first.text == "Radial error motion, rms along a direction (k = 2): J1 3.46 µm, U = 0.25 µm."
    assert (first.sign, first.short, first.expanded) == (
        Sign.NEUTRAL,
        "J1 3.5 µm",
        "J1 3.46 µm, U = 0.25 µm",
    )
    assert "not in U: the indicator's own error (u_indicator_um) and the artefact's" in others[0].text
    assert table(section, "error-motion-values").rows == (("J1", "x", 9.0, 8.0, 1.5, 0.4, 1.0),)


def test_certificates_leave_nothing_open() -> None:
    stored = StoredMotion(2, {"J1/result": motion(3.0, 0.1)}, u_indicator_um=0.1, form_um=0.2)
    assert not [each for each in said(error_motion_section(read(stored))) if each.sign is Sign.ATTENTION]


def test_a_motion_below_its_uncertainty_has_a_limit() -> None:
    section = error_motion_section(read(StoredMotion(2, {"J1/result": motion(0.2, 0.2)})))
    assert said(section)[0].text.endswith(" Not resolved: J1, at most 0.60 µm (rms + U).")
    # A good axis is no reason to measure again.
    assert said(section)[0].sign is Sign.NEUTRAL


@pytest.mark.parametrize(("to_deg", "attention"), [(90.0, 1), (100.0, 0)])
def test_a_short_arc_is_said(to_deg: float, attention: int) -> None:
    found = {"J1/result": motion(3.0, 0.1) | {"to_deg": to_deg}}
    stored = StoredMotion(2, found, u_indicator_um=0.1, form_um=0.2)
    texts = [each.text for each in said(error_motion_section(read(stored))) if each.sign is Sign.ATTENTION]
    assert len(texts) == attention
    assert all("over 230° alone" in text for text in texts)


def test_a_run_from_before_has_no_u_of_the_average() -> None:
    found = motion(3.0, 0.1)
    del found["expanded_average_um"]
    section = error_motion_section(read(StoredMotion(2, {"J1/result": found})))
    assert table(section, "error-motion-values").rows[0][-1] is None


@pytest.mark.parametrize("cycles", [1, 2])
def test_error_motions_are_drawn_while_they_are_read(cycles: int) -> None:
    (figure,) = (
        block
        for block in error_motion_section(read(StoredMotion(cycles, {}))).blocks
        if isinstance(block, Figure)
    )
    (panel,) = figure.rows[0]
    assert panel is not None
    down, up = (mark for mark in panel.marks if isinstance(mark, Points))
    for mark in (down, up):
        assert mark.y == pytest.approx(3.0 * np.cos(np.deg2rad(2.0 * mark.x)))

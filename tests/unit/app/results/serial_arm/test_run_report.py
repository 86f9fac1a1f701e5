"""What runs on a serial arm found: tables by hand from stored steps and rows."""

import math
from typing import Any, cast

import numpy as np
import pytest

from catseye.app.results.figures import Figure, Level, Points
from catseye.app.results.model import Section, Statement, Table
from catseye.app.results.serial_arm.axis_report import axis_section
from catseye.app.results.serial_arm.instrument_report import instrument_section
from catseye.app.results.serial_arm.run_report import serial_sections
from catseye.app.results.serial_arm.warmup_report import warmup_section
from catseye.app.store.reader import RunReader, StoredStep
from catseye.procedures.serial_arm.tracker_warmup import WarmupParams

UP_DEG = np.arange(-40.0, 41.0, 10.0)
PLAY_DEG = 0.02
RADIUS_MM = 200.0


class Stored:
    """A run with steps and rows."""

    def __init__(self, procedure: str, steps: dict[str, Any], **tables: list[dict[str, Any]]) -> None:
        params = WarmupParams(window_min=10.0, limit_um_per_10min=20.0)
        self.meta = {"procedure": procedure, "params": params.model_dump(mode="json")}
        self._steps, self._tables = steps, tables

    def steps(self) -> list[StoredStep]:
        return [StoredStep(name, 1, name, "", "", 1, result, 0) for name, result in self._steps.items()]

    def result(self, step_id: str) -> Any:
        return self._steps.get(step_id)

    def rows(self, table: str) -> list[dict[str, Any]]:
        return self._tables.get(table, [])


def turned() -> Stored:
    """A joint with play, turned up and back, its target on a circle."""
    rows = []
    for up in (True, False):
        for command in UP_DEG if up else UP_DEG[::-1]:
            angle = math.radians(command + (-0.5 if up else 0.5) * PLAY_DEG)
            place = (RADIUS_MM * math.cos(angle), RADIUS_MM * math.sin(angle), 5.0)
            named = dict(zip(("x_mm", "y_mm", "z_mm"), place, strict=True))
            rows.append({"step_id": "axis/J2", "q": [1.0, float(command), 2.0], **named})
    line = {"joint": "J2", "target": "N1", "low_deg": -40.0, "high_deg": 40.0, "radius_mm": RADIUS_MM}
    line |= {"tangential_range_mm": 0.1, "angular_range_deg": 0.02, "backlash_deg": -PLAY_DEG}
    line |= {"radial_std_mm": 0.0, "axial_std_mm": 0.0, "hidden": [50.0]}
    return Stored("axis-analysis", {"axis/J2": line}, targets=rows)


def tables(section: Section) -> dict[str, Table]:
    return {block.key: block for block in section.blocks if isinstance(block, Table)}


def short_of(section: Section) -> str:
    (said,) = [block for block in section.blocks if isinstance(block, Statement)]
    return said.short


def points(section: Section, key: str) -> list[Points]:
    (figure,) = [one for one in section.blocks if isinstance(one, Figure) and one.key == key]
    panels = [panel for row in figure.rows for panel in row if panel is not None]
    return [mark for panel in panels for mark in panel.marks if isinstance(mark, Points)]


def test_a_joint_has_a_line_of_its_own() -> None:
    ((*line, hidden),) = tables(axis_section(cast("RunReader", turned())))["axes"].rows
    assert line[:4] == ["J2", "N1", -40.0, 40.0]
    assert line[7] == -PLAY_DEG
    assert hidden == 1


def test_single_axes_have_a_figure_for_the_days_list() -> None:
    assert short_of(axis_section(cast("RunReader", turned()))) == "tangential ≤ 0.100 mm"


def test_both_ways_are_drawn_apart_by_the_play() -> None:
    below, above = points(axis_section(cast("RunReader", turned())), "axis-angular")
    assert np.asarray(below.x).tolist() == UP_DEG.tolist()
    assert np.asarray(above.x).tolist() == UP_DEG[::-1].tolist()
    assert above.y[::-1] - below.y == pytest.approx(np.full(len(UP_DEG), PLAY_DEG), abs=1e-6)


def test_tangential_errors_are_arcs() -> None:
    below, above = points(axis_section(cast("RunReader", turned())), "axis-tangential")
    arc_mm = RADIUS_MM * math.radians(PLAY_DEG)
    assert above.y[::-1] - below.y == pytest.approx(np.full(len(UP_DEG), arc_mm), abs=1e-4)


def test_nests_and_lengths_of_an_instrument() -> None:
    seen = {"hidden": False, "nest": "W1", "repeatability_mm": 0.01, "two_face_mm": 0.02}
    lengths = [
        {"what": "scale bar", "from_point": "a", "to_point": "b", "laid": 1, "error_mm": 0.03},
        {"what": "scale bar", "from_point": "a", "to_point": "b", "laid": 2, "error_mm": -0.01},
    ]
    both = {"measured_mm": 1000.0, "reference_mm": 1000.0}
    stored = Stored(
        "instrument-check",
        {"nest/W1": seen, "nest/W2": {"hidden": True}},
        lengths=[{**one, **both} for one in lengths],
    )
    section = instrument_section(cast("RunReader", stored))
    assert short_of(section) == "lengths off ≤ 0.030 mm"
    found = tables(section)
    assert found["nests"].rows == (("W1", 0.01, 0.02),)
    (errors,) = found["length-errors"].rows
    assert errors[:2] == ("scale bar", 2)
    assert errors[2:] == pytest.approx((0.01, 0.0008**0.5, 0.03))
    assert [marks.y.tolist() for marks in points(section, "instrument-nests")] == [[0.01], [0.02]]
    (drawn,) = points(section, "instrument-lengths")
    assert drawn.y.tolist() == [0.03, -0.01]


def test_nests_in_one_face_are_drawn_without_the_other() -> None:
    seen = {"hidden": False, "nest": "W1", "repeatability_mm": 0.01, "two_face_mm": None}
    section = instrument_section(cast("RunReader", Stored("instrument-check", {"nest/W1": seen})))
    assert [marks.y.tolist() for marks in points(section, "instrument-nests")] == [[0.01]]
    assert short_of(section) == "scatter ≤ 0.010 mm"


def test_a_check_without_lengths_says_so() -> None:
    seen = {"hidden": False, "nest": "W1", "repeatability_mm": 0.01, "two_face_mm": 0.036}
    section = instrument_section(cast("RunReader", Stored("instrument-check", {"nest/W1": seen})))
    (said,) = [block for block in section.blocks if isinstance(block, Statement)]
    assert (
        said.text
        == "Repeats scatter by 0.010 mm at most; both faces differ by 0.036 mm at most; no length was checked."
    )
    assert said.short == "faces ≤ 0.036 mm"


def test_a_warm_up_shows_its_drift_and_limit() -> None:
    # 6 µm from visit to visit, two minutes apart: 30 µm in ten minutes.
    steps: dict[str, Any] = {
        f"visit/{k:04d}": {"clock_s": 120.0 * k, "place_mm": [0.006 * k, 0.0, 0.0]} for k in range(8)
    }
    section = warmup_section(cast("RunReader", Stored("tracker-warmup", steps)))
    drifts = [row[3] for row in tables(section)["warm-up"].rows]
    assert drifts[:5] == [None] * 5
    assert drifts[5:] == pytest.approx([30.0] * 3)
    (figure,) = [one for one in section.blocks if isinstance(one, Figure)]
    levels = [
        mark.at
        for row in figure.rows
        for panel in row
        if panel
        for mark in panel.marks
        if isinstance(mark, Level)
    ]
    assert levels == [20.0]


def test_other_runs_have_found_nothing_here() -> None:
    assert serial_sections(cast("RunReader", Stored("open-loop", {}))) == []

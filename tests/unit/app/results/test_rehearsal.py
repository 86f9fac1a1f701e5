"""A rehearsed plan: as a report and as data."""

from dataclasses import replace
from pathlib import Path

import pytest

from catseye.app.cell.load import load_cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.engine.dry_run import DryRunContext
from catseye.app.protocol.procedures import load_procedure
from catseye.app.protocol.rehearsal import Rehearsal
from catseye.app.render.text import statement_lines, tables_text
from catseye.app.results.rehearsal import brief_text, rehearsal_report
from catseye.app.service.rehearsal import rehearsal_of
from catseye.app.service.running import PlannedRun
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.records import Row
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.open_loop.open_loop import OpenLoopParams
from catseye.procedures.scara.system import ScaraSystem
from tests.unit.procedures.benches import bench

BENCH: ScaraBench = bench(places={"P1": (650.0, 0.0)})


def planned(folder: Path) -> PlannedRun:
    cell = folder / "cell.toml"
    cell.write_text(TEMPLATE, encoding="utf-8")
    return PlannedRun(
        load_cell(cell),
        load_procedure("open-loop"),
        OpenLoopParams(),
        BENCH,
        None,
        "cell file",
        aim_simulated=None,
    )


async def rehearsed(turn_deg: float = 0.02) -> DryRunContext:
    """Zero at 100 mm from the reflector, turn J1, measure there; then fold the arm away and ask."""
    dry = DryRunContext(ScaraSystem(BENCH), (0.0, 0.0, 12.5, 0.0))

    async def tracked() -> Row:
        await dry.zero(100.0)
        await dry.move((turn_deg, 0.0, 12.5, 0.0))
        await dry.measure(0.5, 0.25, 4)
        return {}

    async def away() -> Row:
        await dry.move((90.0, 0.0, 12.5, 0.0))
        await dry.ask(Prompt("stage/1", "confirm", "Turn the screw."))
        await dry.warn("the screw is stiff")
        return {}

    await dry.step("near", "with the beam", tracked)
    await dry.step("away", "without", away)
    return dry


async def report_lines(planned: PlannedRun, turn_deg: float = 0.02) -> tuple[list[str], str]:
    """Return the lines of the table, and the statements as one text."""
    report = rehearsal_report(rehearsal_of(planned, await rehearsed(turn_deg)))
    return tables_text(report).splitlines(), "\n".join(statement_lines(report))


async def test_the_table_has_a_line_for_each_step(tmp_path: Path) -> None:
    (head, _, near, away), said = await report_lines(planned(tmp_path))
    assert head.split()[:6] == ["step", "moves", "points", "time", "s", "beam"]
    assert [name in head for name in ("joint deg/s", "tool mm/s", "beam mm", "miss mm")] == [True] * 4
    # 0.02 deg at 650 mm miss by 0.227 mm; the arm of 550 mm stands 100 mm away.
    assert near.split()[0] == "near"
    assert near.split()[4:6] == ["100.0", "0.227"]
    # 90 deg at 20 % of 420 deg/s.
    assert away.split()[4:8] == ["–", "–", "84.0", "806"]
    assert "2 steps, 2 moves, 1 distance, about" in said
    assert "fastest joint 84.0 deg/s, tool 806 mm/s; the beam misses by 0.227 mm at most" in said
    assert "warning: the screw is stiff" in said
    assert said.endswith("1 question: stage/1 after 2 s")


async def test_what_a_tracker_measures_is_no_distance(tmp_path: Path) -> None:
    rehearsal = rehearsal_of(planned(tmp_path), await rehearsed())
    of_tracker = rehearsal.model_copy(update={"procedure": "tracker-calibration"})
    assert "2 moves, 1 measurement, about" in "\n".join(statement_lines(rehearsal_report(of_tracker)))


async def test_data_have_the_same_figures(tmp_path: Path) -> None:
    data = rehearsal_of(planned(tmp_path), await rehearsed()).model_dump(mode="json")
    near, away = data["steps"]
    assert (near["miss_mm"], data["miss_mm"]) == pytest.approx((0.2269, 0.2269), abs=1e-4)
    assert (near["beam_mm"], away["beam_mm"], away["miss_mm"]) == (pytest.approx(100.0, abs=0.01), None, None)
    assert (away["joint_deg_s"], data["joint_deg_s"]) == (pytest.approx(84.0), pytest.approx(84.0))
    assert data["tool_mm_s"] == pytest.approx(806.3, abs=0.5)
    (question,) = data["questions"]
    # 0.5 s settling and 0.25 s dwell, 90 deg at 84 deg/s and a little more: it is asked at the very end.
    assert question.pop("after_s") == pytest.approx(near["duration_s"] + away["duration_s"], abs=1e-3)
    assert question == {"id": "stage/1", "kind": "confirm", "text": "Turn the screw."}
    assert data["warnings"][0] == "the screw is stiff"
    assert "max_miss_mm = 0.2 in 1 step(s); the cat's eye still returns it" in data["warnings"][1]


async def test_data_keep_their_keys(tmp_path: Path) -> None:
    data = rehearsal_of(planned(tmp_path), await rehearsed()).model_dump(mode="json")
    assert set(data) == {
        *("procedure", "total_s", "override_percent", "joint_deg_s", "tool_mm_s", "miss_mm", "max_miss_mm"),
        *("joints", "steps", "warnings", "questions"),
    }
    assert set(data["steps"][0]) == {
        *("step", "title", "moves", "measurements", "duration_s", "first", "end", "joint_deg_s", "tool_mm_s"),
        *("beam_mm", "miss_mm"),
    }


async def test_data_give_the_same_report(tmp_path: Path) -> None:
    rehearsal = rehearsal_of(planned(tmp_path), await rehearsed())
    again = Rehearsal.model_validate_json(rehearsal.model_dump_json())
    assert tables_text(rehearsal_report(again)) == tables_text(rehearsal_report(rehearsal))
    assert brief_text(again) == brief_text(rehearsal)


@pytest.mark.parametrize(
    ("turn_deg", "verdict"), [(0.01, None), (0.05, "still returns it"), (0.2, "it breaks")]
)
async def test_a_miss_beyond_the_plans_limit_is_a_warning(
    tmp_path: Path, turn_deg: float, verdict: str | None
) -> None:
    _, said = await report_lines(planned(tmp_path), turn_deg)
    assert ("on the way of near" in said) == (verdict is not None)
    assert verdict is None or verdict in said
    assert ("every limit of the cell file holds" in said) == (verdict is None)
    assert ("max_miss_mm does not" in said) == (verdict is not None)


async def test_a_led_arm_names_its_speed(tmp_path: Path) -> None:
    led = replace(BENCH, arm=replace(BENCH.arm, following="streamed"))
    _, said = await report_lines(replace(planned(tmp_path), bench=led))
    assert "20 % override, led at 20 deg/s at most" in said

"""What a rehearsal says: table, data, warnings, questions."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from catseye.app.cell.load import load_cell
from catseye.app.cell.template import TEMPLATE
from catseye.app.cli.rehearsal import write_rehearsal
from catseye.app.engine.dry_run import DryRunContext
from catseye.app.engine.gate import JointLimits
from catseye.app.protocol.procedures import load_procedure
from catseye.app.service.running import PlannedRun
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.records import Row
from catseye.procedures.scara.open_loop.open_loop import OpenLoopParams
from tests.unit.procedures.benches import bench

LIMITS = JointLimits((-170.0, 170.0), (-145.0, 145.0), (-360.0, 360.0))
BENCH: Bench = bench(places={"P1": (650.0, 0.0)})


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
    dry = DryRunContext(LIMITS, BENCH, pose=(0.0, 0.0, 12.5, 0.0))

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


async def test_the_table_has_a_line_for_each_step(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_rehearsal(planned(tmp_path), await rehearsed(), as_json=False)
    said = capsys.readouterr()
    head, _, near, away = said.out.splitlines()
    assert head.split("  ")[0] == "step"
    assert [name in head for name in ("joint deg/s", "tool mm/s", "beam mm", "miss mm")] == [True] * 4
    # 0.02 deg at 650 mm miss by 0.227 mm; the arm of 550 mm stands 100 mm away.
    assert near.split()[0] == "near"
    assert near.split()[-2:] == ["100.0", "0.227"]
    # 90 deg at 20 % of 420 deg/s.
    assert away.split()[-4:] == ["84.0", "806", "–", "–"]
    assert "2 steps, 2 moves, 1 distances" in said.err
    assert "fastest joint 84.0 deg/s, tool 806 mm/s; the beam misses by 0.227 mm at most" in said.err
    assert "warning: the screw is stiff" in said.err
    assert said.err.rstrip().endswith("1 question: stage/1")


async def test_data_have_the_same_figures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_rehearsal(planned(tmp_path), await rehearsed(), as_json=True)
    told = json.loads(capsys.readouterr().out)
    near, away = told["steps"]
    assert (near["miss_mm"], told["miss_mm"]) == pytest.approx((0.2269, 0.2269), abs=1e-4)
    assert (near["beam_mm"], away["beam_mm"], away["miss_mm"]) == (pytest.approx(100.0, abs=0.01), None, None)
    assert (away["joint_deg_s"], told["joint_deg_s"]) == (pytest.approx(84.0), pytest.approx(84.0))
    assert told["tool_mm_s"] == pytest.approx(806.3, abs=0.5)
    assert told["questions"] == [{"id": "stage/1", "kind": "confirm", "text": "Turn the screw."}]
    assert told["warnings"][0] == "the screw is stiff"
    assert "max_miss_mm = 0.2 in 1 step(s); the cat's eye still returns it" in told["warnings"][1]


@pytest.mark.parametrize(("turn_deg", "told"), [(0.01, None), (0.05, "still returns it"), (0.2, "it breaks")])
async def test_a_miss_beyond_the_plans_limit_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], turn_deg: float, told: str | None
) -> None:
    write_rehearsal(planned(tmp_path), await rehearsed(turn_deg), as_json=False)
    said = capsys.readouterr().err
    assert ("on the way of near" in said) == (told is not None)
    assert told is None or told in said
    assert ("every limit of the cell file holds" in said) == (told is None)
    assert ("max_miss_mm does not" in said) == (told is not None)


async def test_a_led_arm_names_its_speed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    led = replace(BENCH, arm=replace(BENCH.arm, following="streamed"))
    write_rehearsal(replace(planned(tmp_path), bench=led), await rehearsed(), as_json=False)
    assert "20 % override, led at 20 deg/s at most" in capsys.readouterr().err

"""The results of one arm over months: what has changed since the baseline, in u of the difference."""

import json
import math
import os
from pathlib import Path
from typing import Any

import pytest
from matplotlib.container import ErrorbarContainer
from typer.testing import CliRunner

from catseye.app.cli import cli
from catseye.app.cli.init import init
from catseye.app.errors import UsageError
from catseye.app.render.mpl import drawn
from catseye.app.render.page import page_html
from catseye.app.results.model import Sign
from catseye.app.results.resolution.result import write_resolution
from catseye.app.results.scara.result import write_result
from catseye.app.results.serial_arm.result import write_serial_arm
from catseye.app.results.stored_results import stored_results
from catseye.app.results.trend.course import Trend
from catseye.app.results.trend.document import trend_document
from catseye.app.results.trend.found import results_of_cell, trend_of
from catseye.app.results.trend.report import trend_report, trend_statement
from catseye.app.store.run_store import RunStore
from catseye.procedures.kit.records import Json
from tests.unit.app.results.resolution.sample import sample_result
from tests.unit.app.results.scara.test_comparison import estimate, result, table, with_budget
from tests.unit.app.results.serial_arm.sample import sample_calibration
from tests.unit.app.store.fakes import TickingClock

MONTHS = ("20260105T080000Z", "20260309T080000Z", "20260612T080000Z")


def run_of(month: int) -> str:
    return f"{MONTHS[month]}_open-loop_00000{month}"


def largest(trend: Trend, number: int) -> tuple[Any, ...]:
    """Return name and size of the largest change of a result."""
    found = trend.largest(number)
    assert found is not None
    return found


def three_months(folder: Path) -> Trend:
    """Return an arm whose J2 has changed by 2.9 u of the difference at one node in the third month."""
    moved = table([0.0, 20.0], [1.0, 3.0 + 2.9 * 0.4 * math.sqrt(2.0)], [5.0, 7.0], 0.4)
    # Written in another order than they were measured.
    write_result(result(run_of(2), theta2_map=moved), folder / "a.json")
    write_result(result(run_of(0)), folder / "b.json")
    write_result(result(run_of(1), link1_mm=estimate(325.014, 0.004)), folder / "c.json")
    return trend_of("lab-1", stored_results([folder]))


def many_months(folder: Path, count: int) -> Trend:
    for month in range(count):
        run = f"2026{month + 1:02d}05T080000Z_open-loop_{month:06d}"
        moved = table([0.0, 20.0], [1.0 + 0.1 * month, 3.0], [5.0, 7.0 - 0.2 * month], 0.4)
        link = estimate(325.01 + 0.001 * month, 0.004)
        write_result(result(run, link1_mm=link, theta2_map=moved), folder / f"{month}.json")
    return trend_of("lab-1", stored_results([folder]))


@pytest.mark.parametrize("count", [3, 9])
def test_each_curve_is_told_apart_by_its_legend_without_colours(tmp_path: Path, count: int) -> None:
    figures = trend_report(many_months(tmp_path, count)).figures("figures")
    assert len(figures) >= 4
    for figure in figures:
        whole = drawn(figure)
        legends = [*whole.legends, *(axes.legend_ for axes in whole.axes if axes.legend_ is not None)]
        named: dict[str, tuple[str, str]] = {}
        for axes in whole.axes:
            for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
                assert named.setdefault(label, print_look(handle)) == print_look(handle)
        # One legend a figure, and no two of its entries look alike in greys.
        assert len(legends) == (1 if named else 0)
        assert len(set(named.values())) == len(named)


def print_look(handle: Any) -> tuple[str, str]:
    """Return dash and marker of a curve, with error bars or not."""
    line = handle.lines[0] if isinstance(handle, ErrorbarContainer) else handle
    return str(getattr(line, "_unscaled_dash_pattern", line.get_linestyle())), str(line.get_marker())


def test_maps_of_many_months_name_the_newest_and_the_oldest(tmp_path: Path) -> None:
    (*_, maps) = trend_report(many_months(tmp_path, 9)).figures("figures")
    (legend,) = drawn(maps).legends
    texts = [text.get_text() for text in legend.get_texts()]
    newest = [f"2026-{month:02d}-05" for month in range(5, 10)]
    assert texts == ["2026-01-05", "the others", *newest]


def test_changes_are_stated_in_u_of_the_difference(tmp_path: Path) -> None:
    trend = three_months(tmp_path)
    assert [one.path.name for one in trend.results] == ["b.json", "c.json", "a.json"]
    assert trend.largest(0) is None
    # 4 µm with u = 3 µm and 4 µm.
    assert largest(trend, 1) == ("L1", pytest.approx(0.8))
    assert largest(trend, 2) == ("Δθ2(20°, +)", pytest.approx(2.9))
    assert (trend.within(2), len(trend.changes(2))) == (9, 10)
    said = trend_statement(trend)
    assert said.sign is Sign.GOOD
    assert "9 of 10 changes lie within 2" in said.text
    assert "+2.9 u, Δθ2(20°, +)" in said.text
    assert "2026-06-12 08:00 against the baseline of 2026-01-05 08:00" in said.text


def test_a_single_node_is_spoken_of(tmp_path: Path) -> None:
    # One of 42 changes by 4 u: the share within 2 u alone would say that nothing has happened.
    nodes = [float(10 * place) for place in range(10)]
    zeros = [0.0] * len(nodes)
    moved = table(nodes, [*zeros[:-1], 4.0 * 0.4 * math.sqrt(2.0)], zeros, 0.4)
    still = table(nodes, zeros, zeros, 0.4)
    write_result(result(run_of(0), theta1_map=still, theta2_map=still), tmp_path / "a.json")
    write_result(result(run_of(1), theta1_map=still, theta2_map=moved), tmp_path / "b.json")
    said = trend_statement(trend_of("lab-1", stored_results([tmp_path])))
    assert said.sign is Sign.ATTENTION
    assert "41 of 42 changes lie within 2" in said.text
    assert "Beyond 3 u lies 1 change where chance alone accounts for 0.1: Δθ2(90°, +) (+4.0 u)" in said.text


def test_any_result_can_be_the_baseline(tmp_path: Path) -> None:
    three_months(tmp_path)
    trend = trend_of("lab-1", stored_results([tmp_path]), Path("a.json"))
    assert trend.baseline == 2
    assert largest(trend, 0) == ("Δθ2(20°, +)", pytest.approx(-2.9))
    with pytest.raises(UsageError, match=r"d\.json is not a result of this arm; there are b\.json, c\.json"):
        trend_of("lab-1", stored_results([tmp_path]), Path("d.json"))


def test_what_all_results_share_counts_once(tmp_path: Path) -> None:
    for month in range(2):
        write_result(with_budget(run_of(month), 0.6), tmp_path / f"{month}.json")
    trend = trend_of("lab-1", stored_results([tmp_path]))
    (node,) = [one for one in trend.courses if one.name == "Δθ2(0°, +)"]
    (_, later) = node.values
    assert later is not None
    assert later.change is not None
    assert later.u == pytest.approx(0.4)
    assert later.change.u == pytest.approx(0.4 * math.sqrt(2.0 - 2.0 * 0.36))


def test_reflectors_are_shown_and_not_judged(tmp_path: Path) -> None:
    write_result(result(run_of(0)), tmp_path / "a.json")
    elsewhere = [{"name": "P1", "x_mm": estimate(700.0, 0.02), "y_mm": estimate(-400.0, 0.03)}]
    write_result(result(run_of(1), reflectors=elsewhere), tmp_path / "b.json")
    trend = trend_of("lab-1", stored_results([tmp_path]))
    assert largest(trend, 1) == ("L1", 0.0)
    assert {one.name for one in trend.courses if not one.judged} == {"P1 x", "P1 y"}


def test_one_result_makes_no_trend(tmp_path: Path) -> None:
    write_result(result(run_of(0)), tmp_path / "a.json")
    with pytest.raises(
        UsageError, match=r"lab-1 has 1 result: a trend needs at least two.*; left out: b\.json"
    ):
        trend_of("lab-1", stored_results([tmp_path]), remarks=["left out: b.json, another robot since"])


def test_page_and_document_hold_every_result(tmp_path: Path) -> None:
    trend = three_months(tmp_path)
    page = page_html(trend_report(trend))
    for text in ("2026-01-05, baseline", "b.json", "Error maps over months", "325.0100 ± 0.0060"):
        assert text in page
    document = trend_document(trend).json_object()
    assert [entry["largest_of"] for entry in document["results"]] == ["", "L1", "Δθ2(20°, +)"]
    (link,) = [entry for entry in document["courses"] if entry["name"] == "L1"]
    assert [value["value"] for value in link["values"]] == [325.01, 325.014, 325.01]
    assert link["values"][1]["u_change"] == pytest.approx(0.005)


def test_a_serial_arm_is_followed_too(tmp_path: Path) -> None:
    found = sample_calibration()
    write_serial_arm(found, tmp_path / "a.json")
    parameter = next(one for one in found.parameters if one.identified and not one.name.startswith("base."))
    changed = [
        one.model_copy(update={"value": one.value + 5.0 * one.u}) if one.name == parameter.name else one
        for one in found.parameters
    ]
    write_serial_arm(found.model_copy(update={"parameters": changed}), tmp_path / "b.json")
    trend = trend_of("arm", stored_results([tmp_path]), Path("a.json"))
    other = 1 - trend.baseline
    assert largest(trend, other) == (parameter.name, pytest.approx(5.0 / math.sqrt(2.0)))
    assert trend_report(trend).figures("figures")


def test_least_steps_are_followed_too(tmp_path: Path) -> None:
    found = sample_result()
    for name in ("a.json", "b.json"):
        write_resolution(found, tmp_path / name)
    trend = trend_of("arm", stored_results([tmp_path]))
    assert any(one.name.endswith("least step") for one in trend.courses)
    assert all(one.largest() == 0.0 for one in trend.courses)


async def stored(root: Path, cell: str, serial: str, *, started_s: int = 0, simulated: bool = False) -> str:
    robot: Json = {"model": "RH-1", "serial": serial, "firmware": "", "simulated": simulated}
    meta: dict[str, Json] = {"cell": cell, "simulated": simulated, "devices": {"robot": robot}}
    clock = TickingClock()
    clock.ticks = started_s
    store = await RunStore.create(root, "open-loop", meta, clock, reserve_bytes=0)
    await store.finish("complete", 0)
    return store.path.name


def written(runs: dict[str, str], folder: Path) -> None:
    """Write a result of each run, in this order."""
    for number, (name, run) in enumerate(runs.items()):
        path = folder / f"{name}.json"
        write_result(result(run), path)
        os.utime(path, (1e9 + number, 1e9 + number))


async def test_results_of_a_cell_are_those_of_its_robot(tmp_path: Path) -> None:
    root = tmp_path / "runs"
    runs = {"old": await stored(root, "lab-1", "R-1"), "other": await stored(root, "lab-2", "R-2")}
    runs |= {"new": await stored(root, "lab-1", "R-2", started_s=9), "gone": run_of(0)}
    written(runs, tmp_path)
    found, remarks = results_of_cell("lab-1", root, [tmp_path])
    assert [one.path.name for one in found] == ["new.json"]
    assert remarks == ["left out: old.json, another robot since"]


async def test_a_file_written_later_makes_no_robot_the_present_one(tmp_path: Path) -> None:
    root = tmp_path / "runs"
    old, new = await stored(root, "lab-1", "R-1"), await stored(root, "lab-1", "R-2", started_s=9)
    written({"new": new, "identified again": old}, tmp_path)
    found, _ = results_of_cell("lab-1", root, [tmp_path])
    assert [one.path.name for one in found] == ["new.json"]


async def test_a_later_rehearsal_does_not_replace_a_real_arm(tmp_path: Path) -> None:
    root = tmp_path / "runs"
    real = await stored(root, "lab-1", "R-1")
    emulated = await stored(root, "lab-1", "R-1", started_s=9, simulated=True)
    written({"real": real, "emulated": emulated}, tmp_path)
    found, remarks = results_of_cell("lab-1", root, [tmp_path])
    assert [one.path.name for one in found] == ["real.json"]
    assert remarks == ["left out: emulated.json, made in simulation"]


async def test_a_robot_without_a_serial_number_is_remarked_on(tmp_path: Path) -> None:
    root = tmp_path / "runs"
    runs = {"old": await stored(root, "lab-1", ""), "new": await stored(root, "lab-1", "R-2", started_s=9)}
    written(runs, tmp_path)
    found, remarks = results_of_cell("lab-1", root, [tmp_path])
    assert [one.path.name for one in found] == ["new.json", "old.json"]
    assert remarks == [
        "the robot of old.json stated no serial number: that it was this arm rests on the name of the cell"
    ]


async def test_the_command_takes_results_from_elsewhere(tmp_path: Path) -> None:
    cell, root = tmp_path / "cell.toml", tmp_path / "runs"
    init(cell)
    write_result(result(await stored(root, "lab-1", "R-1")), tmp_path / "own.json")
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    write_result(result(run_of(0)), elsewhere / "january.json")
    words: list[Any] = ["trend", cell, elsewhere / "january.json", "--runs", root, "--json"]
    words += ["-o", tmp_path / "trend.html"]
    done = CliRunner().invoke(cli, list(map(str, words)))
    assert done.exception is None, done.output
    document = json.loads(done.stdout)
    assert {Path(entry["file"]).name for entry in document["results"]} == {"own.json", "january.json"}
    assert "Trend of lab-1" in (tmp_path / "trend.html").read_text(encoding="utf-8")

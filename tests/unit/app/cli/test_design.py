"""The design command: what it finds, writes and refuses."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from catseye.app.cell.load import load_cell
from catseye.app.cell.rewriting import with_reflector_tables
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cli.scara.design import design
from catseye.app.errors import ConfigError, StorageError, UsageError, exit_code_of
from catseye.app.exitcode import ExitCode
from catseye.app.results.scara.design import commands as design_commands
from catseye.app.results.scara.design.bench_time import BenchCost, bench_cost
from catseye.calibration.core.errors import UnidentifiableError
from catseye.calibration.core.types import Bools
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.motion.approach import Command

NODES1 = "theta1_deg = [-140.0, -120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0]"
NODES2 = "theta2_deg = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0]"


@pytest.fixture
def cell(tmp_path: Path) -> Path:
    """Return a cell with fewer nodes, which is designed quickly."""
    text = TEMPLATE.replace(NODES1, "theta1_deg = [-120.0, -60.0, 0.0, 40.0]")
    path = tmp_path / "cell.toml"
    path.write_text(text.replace(NODES2, "theta2_deg = [20.0, 60.0, 100.0, 140.0]"))
    return path


def designed(cell: Path, capsys: pytest.CaptureFixture[str], **options: Any) -> dict[str, Any]:
    design(cell, **({"places": 30, "as_json": True} | options))
    document: dict[str, Any] = json.loads(capsys.readouterr().out)
    return document


def edited(cell: Path, old: str, new: str) -> Path:
    text = cell.read_text()
    assert old in text
    cell.write_text(text.replace(old, new))
    return cell


@pytest.mark.parametrize("criterion", ["A", "D", "E", "path"])
@pytest.mark.parametrize("random_only", [False, True])
def test_never_worse_than_the_layout_of_the_cell(
    cell: Path, capsys: pytest.CaptureFixture[str], criterion: str, random_only: bool
) -> None:
    found = designed(cell, capsys, criterion=criterion, random_only=random_only)
    key = f"{criterion}_{'random_' if random_only else ''}{'um' if criterion == 'path' else 'mdeg'}"
    mine, present = found["layouts"][0][key], found["layouts"][1][key]
    assert mine <= present * (1.0 + 1e-9)
    assert found["layouts"][1]["places_mm"] == [[650.0, -400.0], [680.0, 0.0], [640.0, 380.0]]


def test_places_meet_every_constraint(cell: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = designed(cell, capsys, floor="560,900,-500,500", keep_out=620.0, apart=250.0, breaks=1)
    places = np.array([[one["x_mm"], one["y_mm"]] for one in found["reflectors"]])
    assert (places >= [560.0, -500.0]).all()
    assert (places <= [900.0, 500.0]).all()
    assert (np.hypot(*places.T) >= 620.0).all()
    gaps = [np.hypot(*(places[i] - places[j])) for i, j in ((0, 1), (0, 2), (1, 2))]
    assert min(gaps) >= 250.0
    assert all(one["breaks"] <= 1 for one in found["reflectors"])
    assert found["layouts"][0]["planned_breaks"] == sum(one["breaks"] for one in found["reflectors"])


def test_a_read_only_cell_file_is_not_changed(cell: Path, tmp_path: Path) -> None:
    kept = tmp_path / "kept.toml"
    kept.write_text("# released\n", "utf-8")
    kept.chmod(0o444)
    with pytest.raises(StorageError, match=r"kept\.toml: is read-only, and stays as it is"):
        design(cell, places=30, as_json=True, write_cell=kept)
    assert kept.read_text("utf-8") == "# released\n"


def test_same_seed_same_design(cell: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert designed(cell, capsys, seed=4) == designed(cell, capsys, seed=4)


def test_more_of_everything_costs_time_and_lowers_what_averages_out(
    cell: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = designed(cell, capsys, places=120, reflectors=1, pareto=True, random_only=True)["pareto"]
    assert {row["reflectors"] for row in rows} == {1, 2, 3, 4}
    whole = {(row["reflectors"], row["repeats"]): row for row in rows if row["commands"] == 64}
    for count in (1, 2, 3, 4):
        once, thrice = whole[count, 1], whole[count, 3]
        assert thrice["bench_s"] == pytest.approx(3.0 * once["bench_s"])
        # White errors average out: three repeats have a third of the variance.
        assert thrice["u_random"] == pytest.approx(once["u_random"] / np.sqrt(3.0), rel=1e-6)
        assert thrice["u"] > thrice["u_random"]
    assert (
        whole[1, 1]["u_random"] > whole[2, 1]["u_random"] > whole[3, 1]["u_random"] > whole[4, 1]["u_random"]
    )
    for row in rows:
        beaten = [
            other
            for other in rows
            if (other["bench_s"], other["u_random"]) != (row["bench_s"], row["u_random"])
            and other["bench_s"] <= row["bench_s"]
            and other["u_random"] <= row["u_random"]
        ]
        assert row["front"] == (not beaten)


def test_a_layout_that_the_plan_refuses_is_no_compromise(
    cell: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def refusing(bench: ScaraBench, sequence: tuple[Command, ...], kept: Bools | None = None) -> BenchCost:
        if len(bench.reflectors) == 4:
            return BenchCost(float("nan"), 0, 0, 0, "the plan says no")
        return bench_cost(bench, sequence, kept)

    monkeypatch.setattr(design_commands, "bench_cost", refusing)
    rows = designed(cell, capsys, places=120, reflectors=1, pareto=True, random_only=True)["pareto"]
    refused = [row for row in rows if row["reflectors"] == 4]
    # Four reflectors give most information, and still none of these is worth having.
    assert min(row["u_random"] for row in refused) == min(row["u_random"] for row in rows)
    assert {row["bench_s"] for row in refused} == {None}
    assert not any(row["front"] for row in refused)
    assert any(row["front"] for row in rows)


def test_nodes_of_a_scan_are_too_many_for_a_design(cell: Path) -> None:
    nodes = [float(angle) for angle in range(-120, 41)]
    edited(cell, "theta1_deg = [-120.0, -60.0, 0.0, 40.0]", f"theta1_deg = {nodes}")
    finer = [float(angle) for angle in range(20, 141)]
    edited(cell, "theta2_deg = [20.0, 60.0, 100.0, 140.0]", f"theta2_deg = {finer}")
    with pytest.raises(UsageError, match=r"161 and 121 nodes make 77924 commands.*fewer nodes"):
        design(cell)


def test_a_reflector_under_the_arm_is_compared_all_the_same(
    cell: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # The straight arm stands right above P2 (680, 0) at a command of the grid.
    edited(cell, "link1_mm = 325.0", "link1_mm = 400.0")
    edited(cell, "link2_mm = 225.0", "link2_mm = 280.0")
    edited(cell, "theta2_deg = [20.0, 60.0, 100.0, 140.0]", "theta2_deg = [0.0, 60.0, 100.0, 140.0]")
    layouts = designed(cell, capsys)["layouts"]
    assert all(np.isfinite(layout["A_mdeg"]) for layout in layouts)
    assert layouts[1]["refused"]


def test_chosen_commands_keep_every_node_in_both_directions(
    cell: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    target = tmp_path / "commands.csv"
    design(cell, places=30, commands=24, write_commands=target, as_json=True)
    found = json.loads(capsys.readouterr().out)
    commands = found["commands"]
    assert len(commands) == 24
    assert {(one[0], one[2]) for one in commands} == {
        (node, sign) for node in (-120.0, -60.0, 0.0, 40.0) for sign in (1, -1)
    }
    assert {(one[1], one[3]) for one in commands} == {
        (node, sign) for node in (20.0, 60.0, 100.0, 140.0) for sign in (1, -1)
    }
    assert found["commands_bench_s"] < found["layouts"][0]["bench_s"]
    rows = target.read_text().splitlines()
    assert rows[0] == "theta1_deg,theta2_deg,direction1,direction2"
    assert [[float(value) for value in row.split(",")] for row in rows[1:]] == commands


def test_a_bench_time_is_kept(cell: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = designed(cell, capsys, minutes=2.5)
    assert 100.0 < found["commands_bench_s"] <= 150.0


def test_fewer_commands_than_determine_the_arm_are_reported(
    cell: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    design(cell, places=30, commands=3)
    assert "3 commands leave parameters undetermined" in capsys.readouterr().err


def test_tables_and_page(cell: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    page = tmp_path / "design.html"
    design(cell, places=30, commands=24, pareto=True, output=page)
    output = capsys.readouterr()
    assert "cell file (= SCARA paper)" in output.out
    assert "planned breaks of the beam" in output.err
    text = page.read_text()
    for name in ("places", "nodes", "positions", "front"):
        assert f'id="figure-{name}"' in text
    assert "<script" not in text
    assert "inside the keep-out radius" in text


def test_written_cell_differs_in_its_reflectors_only(cell: Path, tmp_path: Path) -> None:
    target = tmp_path / "new.toml"
    design(cell, places=30, write_cell=target)
    old, new = load_cell(cell).cell, load_cell(target).cell
    assert [one.name for one in new.reflector] == ["P1", "P2", "P3"]
    assert all(one.facing_deg is not None for one in new.reflector)
    assert new.model_copy(update={"reflector": old.reflector}) == old
    comments = [line for line in cell.read_text().splitlines() if line.startswith("#")]
    assert comments == [line for line in target.read_text().splitlines() if line.startswith("#")]


def test_reflectors_of_a_file_in_several_parts_cannot_be_replaced(tmp_path: Path) -> None:
    path = tmp_path / "cell.toml"
    path.write_text("[reflector.one]\nx_mm = 1.0\n[robot]\n[reflector.two]\nx_mm = 2.0\n", encoding="utf-8")
    with pytest.raises(ConfigError, match="in one piece"):
        with_reflector_tables(path, [("P1", 1.0, 2.0, 3.0)])


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"floor": "0,100,0,100"}, "nowhere on the floor .* inside the keep-out radius"),
        ({"floor": "0,100"}, "X0,X1,Y0,Y1"),
        ({"floor": "nan,100,0,1"}, "X0,X1,Y0,Y1"),
        ({"floor": "100,0,0,100"}, "is empty"),
        ({"floor": "700,760,0,40", "reflectors": 4}, "4 reflectors do not find room"),
        ({"commands": 30, "minutes": 3.0}, "either --commands or --minutes"),
        ({"minutes": 0.1}, "do not suffice"),
        ({"path": Path("p.csv")}, "--criterion path"),
    ],
)
def test_what_cannot_be_done_is_reported_with_its_remedy(
    cell: Path, options: dict[str, Any], said: str
) -> None:
    with pytest.raises(UsageError, match=said):
        design(cell, **({"places": 30, "as_json": True} | options))


def test_a_path_outside_of_the_nodes_is_refused(cell: Path, tmp_path: Path) -> None:
    path = tmp_path / "path.csv"
    path.write_text("x_mm,y_mm\n-300,100\n-310,100\n")
    with pytest.raises(UsageError, match="inside the nodes"):
        design(cell, criterion="path", path=path, places=30)


def test_a_path_partly_outside_of_the_nodes_is_reported(
    cell: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "path.csv"
    path.write_text("x_mm,y_mm\n400,0\n400,50\n-300,100\n")
    found = designed(cell, capsys, criterion="path", path=path)
    assert found["path"] == "the given path without 1 row outside of the nodes"


def test_commands_that_determine_nothing_are_named(cell: Path) -> None:
    edited(cell, "theta2_deg = [20.0, 60.0, 100.0, 140.0]", "theta2_deg = [40.0, 40.01]")
    with pytest.raises(UnidentifiableError, match="L1") as caught:
        design(cell, reflectors=1, places=30)
    assert exit_code_of(caught.value) == ExitCode.REJECTED


def test_a_budget_without_white_contributors_is_refused(cell: Path) -> None:
    for old in ("value_um = 10.0", "value_um = 0.09", "value_mrad = 0.717"):
        edited(cell, old, old.split(" = ", maxsplit=1)[0] + " = 0.0")
    with pytest.raises(UsageError, match="differs from reading to reading"):
        design(cell, places=30)


def test_it_says_what_a_turned_interferometer_is_worth(
    cell: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = designed(cell, capsys, reflectors=1, places=30)["j4_reversal"]
    assert [one["name"] for one in found] == ["1 designed", "cell file (= SCARA paper)"]
    for one in found:
        for key in ("u_link1_um", "u_link2_um", "u_theta1_mdeg", "u_theta2_mdeg"):
            assert one["turned"][key] <= one["twice"][key] <= one["once"][key]
    # A single reflector leaves J4's odd orders among those of the J1 map.
    assert found[0]["turned"]["u_theta1_mdeg"] < 0.95 * found[0]["twice"]["u_theta1_mdeg"]
    design(cell, reflectors=1, places=30)
    said = capsys.readouterr()
    assert "twice, turned between" in said.out
    assert "interferometer turned by half a turn on J4, against one without the turn: U(L1) × 0." in said.err


def test_without_errors_of_j4_a_turn_is_worth_nothing(cell: Path, capsys: pytest.CaptureFixture[str]) -> None:
    edited(cell, 'axis = "j4"', 'axis = "j1"')
    assert designed(cell, capsys, places=30)["j4_reversal"] == []

"""A measurement as far as it has come: states and innovations of commands of a made-up run."""

import math
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from catseye.app.results.figures import Level, Points
from catseye.app.results.scara import commands_so_far as commands
from catseye.app.results.scara.commands_so_far import MeasurementSoFar, Progress
from catseye.app.results.scara.figures.commands import command_figure, top_view_figure
from catseye.app.results.scara.figures.maps_so_far import growing_map_figure
from catseye.app.store.reader import RunReader, StoredEvent, StoredStep
from catseye.procedures.scara.motion.approach import Command, bidirectional_sequence
from catseye.procedures.scara.open_loop.open_loop import OpenLoopParams
from tests.unit.procedures.benches import LINK1_MM, LINK2_MM, PLACES, bench

NODES1, NODES2 = (-60.0, -20.0, 20.0, 60.0), (20.0, 60.0, 100.0)
COMMANDS = bidirectional_sequence(NODES1, NODES2)
REVERSAL_MDEG = 30.0
OUTLIER_MM = 0.5


def length_mm(command: Command, name: str) -> float:
    """Return the distance of an arm whose J1 stands 30 mdeg further on when approached downwards."""
    one = math.radians(command.theta1_deg + (command.direction1 < 0) * REVERSAL_MDEG * 1e-3)
    two = one + math.radians(command.theta2_deg)
    x = LINK1_MM * math.cos(one) + LINK2_MM * math.cos(two)
    y = LINK1_MM * math.sin(one) + LINK2_MM * math.sin(two)
    return math.dist((x, y), PLACES[name])


class Measured:
    """A run of open-loop with the first points of each reflector."""

    path = Path("/runs/one")
    status = "running"

    def __init__(
        self, counts: dict[str, int], wrong: str = "", left_out: str = "", stop: float = 0.0
    ) -> None:
        params = OpenLoopParams(closures=0, off_node=0, stop_at_mdeg=stop)
        self.meta = {"procedure": "open-loop", "params": params.model_dump(mode="json")}
        self._steps, self._rows = [], []
        for name, count in counts.items():
            for command in COMMANDS[:count]:
                step = f"{name}/{command.index:04d}"
                self._steps.append((step, step != left_out))
                if step != left_out:
                    self._rows.append(self._row(step, command, name, OUTLIER_MM if step == wrong else 0.0))

    def _row(self, step: str, command: Command, name: str, off_mm: float) -> tuple[int, dict[str, Any]]:
        values = {
            key: getattr(command, key) for key in ("theta1_deg", "theta2_deg", "direction1", "direction2")
        }
        length = length_mm(command, name) - length_mm(COMMANDS[0], name) + off_mm
        row = {"step_id": step, "reflector": name, "segment": 0, "displacement_mm": length, "mount_deg": 0.0}
        return len(self._rows) + 1, {**row, **values}

    def placed_rows(self, _table: str) -> list[tuple[int, dict[str, Any]]]:
        return self._rows

    def steps(self) -> list[StoredStep]:
        return [StoredStep(name, 1, name, "", "", 1, {"measured": ok}) for name, ok in self._steps]

    def events(self) -> list[StoredEvent]:
        data: dict[str, Any] = {"u_theta1_mdeg": None, "u_theta2_mdeg": 20.0}
        return [StoredEvent(1, "", "map-known", data, place=6)]


@pytest.fixture
def so_far(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setattr(commands, "aimed_bench", lambda _reader, _root: bench(NODES1, NODES2))

    def look(run: Measured) -> MeasurementSoFar:
        reader = cast("RunReader", run)
        return Progress(reader).look(reader)

    return look


def test_each_command_has_its_state(so_far: Any) -> None:
    found = so_far(Measured({"P1": 10}, left_out="P1/0004"))
    first = found.parts[0]
    assert first.status[:4] == ("measured",) * 4
    assert first.status[4] == "left out"
    assert first.status[9:12] == ("measured", "under way", "planned")
    assert found.now is first
    assert set(found.parts[1].status) == {"planned"}


def test_an_outlier_is_told_by_its_innovation(so_far: Any) -> None:
    found = so_far(Measured({name: len(COMMANDS) for name in PLACES}, wrong="P3/0040"))
    share = found.parts[2].share
    assert share[40] > 3.0
    others = np.delete(share, np.arange(40, len(COMMANDS)))
    assert np.nanmax(np.abs(others)) < 1.0
    (panel,) = command_figure(found, [found.parts[2]]).rows[0]
    assert panel is not None
    outlying = [mark for mark in panel.marks if isinstance(mark, Points) and "above 3 u" in mark.label]
    wrong = COMMANDS[40]
    # A quarter of the spacing beside its node, towards where it was approached from.
    places = list(zip(outlying[0].x, outlying[0].y, strict=True))
    at = (wrong.theta1_deg - 10.0 * wrong.direction1, wrong.theta2_deg - 10.0 * wrong.direction2)
    assert pytest.approx(at) in places
    assert "outlying" in panel.title


def test_the_maps_so_far_are_those_of_the_arm(so_far: Any) -> None:
    found = so_far(Measured({name: len(COMMANDS) for name in PLACES}))
    reversal = np.rad2deg(found.maps.map1_rad[1] - found.maps.map1_rad[0]) * 1e3
    assert reversal == pytest.approx([REVERSAL_MDEG] * len(NODES1), abs=0.5)
    figure = growing_map_figure(found)
    assert figure is not None
    panel = figure.rows[0][0]
    assert panel is not None
    upwards = [mark for mark in panel.marks if isinstance(mark, Points) and mark.label.endswith("upwards")]
    assert upwards[0].y == pytest.approx([-REVERSAL_MDEG / 2] * len(NODES1), abs=0.5)
    assert upwards[0].u is not None


def test_error_bars_shrink_as_distances_come_in(so_far: Any) -> None:
    half = so_far(Measured({"P1": len(COMMANDS), "P2": len(COMMANDS)}))
    whole = so_far(Measured({name: len(COMMANDS) for name in PLACES}))
    assert np.nanmax(whole.maps.u2_rad) < np.nanmax(half.maps.u2_rad)


def test_the_target_is_the_one_asked_for(so_far: Any) -> None:
    def levels(stop: float) -> dict[str, float]:
        found = so_far(Measured({name: len(COMMANDS) for name in PLACES}, stop=stop))
        figure = growing_map_figure(found)
        assert figure is not None
        (panel,) = figure.rows[1]
        assert panel is not None
        return {mark.label: 10.0**mark.at for mark in panel.marks if isinstance(mark, Level)}

    assert levels(2.5) == {"stop at u 2.5 mdeg = U 5 mdeg": pytest.approx(5.0)}
    foreseen = levels(0.0)
    assert [label.split(",")[0] for label in foreseen] == ["J1", "J2"]
    # What the whole plan was said to give is what the whole measurement gives.
    found = so_far(Measured({name: len(COMMANDS) for name in PLACES}))
    expanded_mdeg = [2e3 * np.rad2deg(np.nanmax(u)) for u in (found.maps.u1_rad, found.maps.u2_rad)]
    assert list(foreseen.values()) == pytest.approx(expanded_mdeg, rel=0.02)


def test_a_look_takes_in_only_what_is_new(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(commands, "aimed_bench", lambda _reader, _root: bench(NODES1, NODES2))
    short, long = (cast("RunReader", Measured({"P1": count})) for count in (20, 30))
    progress = Progress(short)
    progress.look(short)
    anew = Progress(long).look(long).parts[0].share
    assert progress.look(long).parts[0].share == pytest.approx(anew, nan_ok=True)


def test_one_sign_stands_for_a_place_seen_from_above(so_far: Any) -> None:
    found = so_far(Measured({"P1": 10}))
    figure = top_view_figure(found, found.now)
    assert figure is not None
    (panel,) = figure.rows[0]
    assert panel is not None
    drawn = [mark for mark in panel.marks if isinstance(mark, Points) and mark.each]
    assert sum(mark.x.size for mark in drawn) == len(NODES1) * len(NODES2)

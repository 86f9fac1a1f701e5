"""A validation path under way: figures against an arm that is worked out by hand from its result file."""

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from catseye.app.results.figures import Figure, Panel, Points
from catseye.app.results.model import Statement
from catseye.app.results.scara.found import path as found
from catseye.app.store.reader import RunReader
from catseye.calibration.core.types import Floats
from tests.unit.app.cli.arms import DOWN2, UP2, bare, bare_map, stored

NOMINAL_MM = (325.0, 225.0)
X_MM = 120.0


class Driven:
    """A run along Y at one X, there and back, measured in a frame of its own."""

    name, procedure = "20261127T120000Z_validation-path_ab12cd", "validation-path"

    def __init__(self, folder: Path, *, distances: bool = False, until: int | None = None) -> None:
        self.path = folder / "runs" / self.name
        way_mm = np.linspace(270.0, 390.0, 13)
        there = [row(X_MM, y, 1) for y in way_mm]
        back = [row(X_MM, y, -1) for y in way_mm[::-1]]
        self._rows = [each | {"pass_number": 0, "u_mm": 0.01} for each in (there + back)[:until]]
        if distances:
            self._rows = [each | {"displacement_mm": 0.0} for each in self._rows]

    def rows(self, _table: str) -> list[dict[str, Any]]:
        return self._rows


def joints_deg(x_mm: float, y_mm: float) -> tuple[float, float]:
    """Return the joints of the nominal arm by the law of cosines, elbow to the right."""
    link1, link2 = NOMINAL_MM
    reach2 = x_mm**2 + y_mm**2
    theta2 = math.acos((reach2 - link1**2 - link2**2) / (2.0 * link1 * link2))
    theta1 = math.atan2(y_mm, x_mm) - math.atan2(link2 * math.sin(theta2), link1 + link2 * math.cos(theta2))
    return math.degrees(theta1), math.degrees(theta2)


def stands_mm(theta1_deg: float, theta2_deg: float, upwards: tuple[bool, bool]) -> tuple[float, float]:
    """Return where the arm of `bare` stands: 325.1 and 224.9 mm, maps linear between their nodes, mdeg."""
    map1_mdeg = (10.0 if upwards[0] else -10.0) + 20.0 * theta1_deg / 90.0
    map2_mdeg = 5.0 if upwards[1] else -5.0
    first = math.radians(theta1_deg + map1_mdeg / 1000.0)
    second = first + math.radians(theta2_deg + map2_mdeg / 1000.0)
    return (
        325.1 * math.cos(first) + 224.9 * math.cos(second),
        325.1 * math.sin(first) + 224.9 * math.sin(second),
    )


def directions(x_mm: float, y_mm: float, way: int) -> tuple[int, int]:
    """Return the signs with which the joints turn at a place of the way."""
    before, after = joints_deg(x_mm, y_mm - 0.01 * way), joints_deg(x_mm, y_mm + 0.01 * way)
    return (1 if after[0] > before[0] else -1), (1 if after[1] > before[1] else -1)


def row(x_mm: float, y_mm: float, way: int) -> dict[str, Any]:
    theta1_deg, theta2_deg = joints_deg(x_mm, y_mm)
    one, two = directions(x_mm, y_mm, way)
    at_x, at_y = stands_mm(theta1_deg, theta2_deg, (one > 0, two > 0))
    # The instrument's frame is turned by 30 deg and shifted.
    c, s = math.cos(math.radians(30.0)), math.sin(math.radians(30.0))
    return {
        "theta1_deg": theta1_deg,
        "theta2_deg": theta2_deg,
        "direction1": one,
        "direction2": two,
        "x_mm": x_mm,
        "y_mm": y_mm,
        "x_meas_mm": c * at_x - s * at_y + 1000.0,
        "y_meas_mm": s * at_x + c * at_y - 70.0,
    }


@pytest.fixture(autouse=True)
def still_bench(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(found, "aimed_bench", lambda *_: SimpleNamespace(take_up_deg=0.5))
    monkeypatch.setattr(found, "result_to_validate", lambda *_: None)
    monkeypatch.setattr(found, "conventional_beside", lambda _newest: None)


def figures_of(run: Driven) -> tuple[Figure, ...]:
    return found.path_figures(cast("RunReader", run))


def panels_of(figure: Figure) -> list[Panel]:
    return [panel for line in figure.rows for panel in line if panel is not None]


def points_of(panel: Panel) -> list[Points]:
    return [mark for mark in panel.marks if isinstance(mark, Points)]


def test_positions_are_a_path_and_distances_are_none(tmp_path: Path) -> None:
    assert found.drives_path(cast("RunReader", Driven(tmp_path)))
    assert not found.drives_path(cast("RunReader", Driven(tmp_path, distances=True)))
    assert not found.drives_path(cast("RunReader", Driven(tmp_path, until=0)))


def test_without_a_result_only_what_was_measured_is_drawn(tmp_path: Path) -> None:
    (figure,) = figures_of(Driven(tmp_path))
    assert "Nothing is predicted" in figure.caption
    assert figures_of(Driven(tmp_path, until=2)) == ()


def test_the_arms_own_result_leaves_nothing_of_its_path(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    result = stored(tmp_path, bare())
    monkeypatch.setattr(found, "result_to_validate", lambda *_: result)
    figures = figures_of(Driven(tmp_path))
    assert [figure.key for figure in figures] == ["path-y", "path-x"]
    for figure in figures:
        deviation, left = panels_of(figure)
        assert max(np.nanmax(abs(points.y)) for points in points_of(left)) < 1e-3
        assert max(np.nanmax(abs(points.y)) for points in points_of(deviation)) > 10.0


def test_predicted_deviations_are_those_of_the_hand_made_arm(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    result = stored(tmp_path, bare())
    monkeypatch.setattr(found, "result_to_validate", lambda *_: result)
    run = Driven(tmp_path)
    for figure, component in zip(figures_of(run), (1, 0), strict=True):
        deviation, _ = panels_of(figure)
        drawn = {
            (round(float(at), 6), points.label.endswith("there"), float(value))
            for points in points_of(deviation)
            if points.hollow
            for at, value in zip(points.x, points.y, strict=True)
        }
        wanted = set()
        for number, each in enumerate(run.rows("")):
            upwards = (each["direction1"] > 0, each["direction2"] > 0)
            stands = stands_mm(each["theta1_deg"], each["theta2_deg"], upwards)
            off_um = 1e3 * (stands[component] - (each["x_mm"], each["y_mm"])[component])
            wanted.add((round(each["y_mm"], 6), number < 13, off_um))
        assert [place[:2] for place in sorted(drawn)] == [place[:2] for place in sorted(wanted)]
        values = np.array([[place[2] for place in sorted(each)] for each in (drawn, wanted)])
        assert np.abs(values[0] - values[1]).max() < 1e-6


def test_beyond_the_map_it_says_why_nothing_is_predicted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    narrow = bare_map([0.0, 40.0], UP2, DOWN2, 0.7)
    result = stored(tmp_path, bare() | {"theta2_map": narrow})
    monkeypatch.setattr(found, "result_to_validate", lambda *_: result)
    (figure,) = figures_of(Driven(tmp_path))
    assert figure.key == "measured-path"
    assert "there is no result" not in figure.caption
    assert "rows lie inside the identified range" in figure.caption


def test_a_path_states_its_deviations_without_any_model(tmp_path: Path) -> None:
    run = Driven(tmp_path)
    stands = np.array([_stands(each) for each in run.rows("")])
    wished = np.array([(each["x_mm"], each["y_mm"]) for each in run.rows("")])
    left = _turned_onto(stands, wished) - wished
    rms_um = 1e3 * math.sqrt(float(np.mean(np.sum(left**2, axis=1))))
    found_section = found.path_section(cast("RunReader", run))
    (statement,) = (block for block in found_section.blocks if isinstance(block, Statement))
    assert f"{rms_um:.1f} µm rms (2D)" in statement.text
    assert "26 positions" in statement.text


def test_a_path_of_distances_says_what_compares_them(tmp_path: Path) -> None:
    (statement,) = found.path_section(cast("RunReader", Driven(tmp_path, distances=True))).blocks
    assert isinstance(statement, Statement)
    assert "26 distances; catseye validate" in statement.text


def _stands(each: dict[str, Any]) -> tuple[float, float]:
    upwards = (each["direction1"] > 0, each["direction2"] > 0)
    return stands_mm(each["theta1_deg"], each["theta2_deg"], upwards)


def _turned_onto(places: Floats, wished: Floats) -> Floats:
    """Return places turned and shifted onto wished ones, by complex numbers."""
    z, w = (xy[:, 0] + 1j * xy[:, 1] for xy in (places, wished))
    turn = np.vdot(z - z.mean(), w - w.mean())
    found_z = (z - z.mean()) * turn / abs(turn) + w.mean()
    return np.stack([found_z.real, found_z.imag], axis=1)

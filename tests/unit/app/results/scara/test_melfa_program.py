"""The program in MELFA-BASIC, carried out line by line by the emulated controller on an arm with known errors."""

import re
from dataclasses import replace

import numpy as np
import pytest

from catseye.app.errors import UsageError
from catseye.app.results.scara.compensated_path import Origin
from catseye.app.results.scara.compensation import CompensatedPath, compensate_path
from catseye.app.results.scara.melfa_program import MelfaSettings, melfa_program
from catseye.app.results.scara.path_csv import CommandPath, ToolWish, cartesian_commands
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.calibration.scara.layout import Layout
from catseye.simulators.world.scara.arm import scara_bench
from catseye.simulators.world.scara.axis_errors import JointMap
from catseye.simulators.world.scara.truth import TrueArm
from catseye.simulators.world.types import TrueState
from tests.unit.simulators.benches import QUIET
from tests.unit.simulators.melfa.desk import Desk

NOMINAL = (325.0, 225.0)
LINKS = (325.06, 224.95)
NODES1, NODES2 = [-170.0, -60.0, 20.0, 170.0], [-10.0, 50.0, 100.0, 144.0]
MAP1 = ([12.0, -20.0, 30.0, 0.0], [30.0, 5.0, 45.0, 20.0])
MAP2 = ([-15.0, 25.0, -20.0, 15.0], [4.0, 44.0, 1.0, 37.0])
ORIGIN = Origin(
    "Größe.json", "error-map", "mean of theta1 map = 0", LINKS, NOMINAL, "2026", "catseye", "2026"
)
SETTINGS = MelfaSettings(j3_mm=50.0, j4_deg=-30.0, override_percent=20.0, settle_time_s=0.5)


def joint_map(nodes: list[float], tables: tuple[list[float], list[float]]) -> JointMap:
    up, down = (np.radians(1e-3 * np.array(table)) for table in tables)
    return JointMap(np.deg2rad(nodes), up, down)


def compensated(y_mm: list[float], c_deg: list[float] | None = None) -> CompensatedPath:
    layout = Layout("error-map", np.deg2rad(NODES1), np.deg2rad(NODES2), (), ())
    mdeg = [*MAP1[0], *MAP1[1], *MAP2[0], *MAP2[1]]
    parameters = np.array([*LINKS, *np.radians(1e-3 * np.array(mdeg))])
    place = np.column_stack([np.full(len(y_mm), 250.0), y_mm])
    tool = ToolWish(c_deg=None if c_deg is None else np.array(c_deg))
    path = CommandPath(cartesian_commands(place, NOMINAL, "right", (1, 1)), place, cartesian=True, tool=tool)
    known = IdentifiedArm(layout, parameters, np.zeros((18, 18)))
    return compensate_path(known, path, NOMINAL, 1.0)


def desk_with_true_arm() -> Desk:
    """Return a controller whose arm has the errors, and nothing random."""
    desk = Desk(replace(QUIET, scara=replace(QUIET.scara, j4_backlash_mdeg=0.0)))
    places = {place.name: (place.x_mm, place.y_mm) for place in QUIET.reflectors}
    truth = TrueArm(*LINKS, joint_map(NODES1, MAP1), joint_map(NODES2, MAP2), places)
    desk.bench = scara_bench(truth, desk.controller.config)
    desk.controller.bench = desk.bench
    return desk


def carried_out(path: CompensatedPath) -> tuple[Desk, list[TrueState]]:
    """Have the controller carry out the program; return how the arm truly stood at each delay."""
    desk = desk_with_true_arm()
    robot = desk.client().ready()
    robot.do(
        "LOAD=PATH", *(f"EDATA{line}" for line in melfa_program(path, ORIGIN, SETTINGS).splitlines()), "SAVE"
    )
    robot.do("PRGLOAD=PATH", "RUNPATH;1")
    stood: list[TrueState] = []
    while desk.controller.task.running:
        # Every delay begins at standstill and is half a second long.
        if desk.controller.task.line_text.endswith("Dly 0.50") and not desk.bench.moving:
            stood.append(desk.bench.true_state())
            desk.bench.advance(0.6)
        else:
            desk.bench.advance(0.01)
    assert robot.ask("ERROR") == "QoK"
    return desk, stood


def test_the_program_brings_the_arm_to_the_path() -> None:
    y_mm = [-200.0, -120.0, -40.0, 40.0, 120.0, 60.0, 59.0, 58.0, -20.0]
    path = compensated(y_mm)
    desk, stood = carried_out(path)
    assert desk.bench.joints[2:] == (50.0, -30.0)
    assert desk.controller.program_override_percent == 20.0
    wished = 250.0 + 1j * np.array(y_mm)
    missed_um = 1e3 * np.abs(np.array([complex(*one.axis_mm) for one in stood]) - wished)
    assert missed_um.size == len(y_mm)
    # Half a step of 1 mdeg of J1 at 550 mm of reach, and of J2 at 225 mm: nothing else is left.
    assert missed_um.max() < 4.8 + 2.0
    assert missed_um == pytest.approx(1e3 * path.rounding_mm, abs=0.01)


def test_the_program_keeps_the_tool_as_the_path_turns_it() -> None:
    y_mm, c_deg = [-200.0, -120.0, -40.0, 40.0, 120.0, 60.0], [90.0, 80.0, 70.0, 60.0, 50.0, 55.0]
    _, stood = carried_out(compensated(y_mm, c_deg))
    # The beam turns with the flange.
    turned = np.array([one.beam_deg for one in stood])
    off_mdeg = 1e3 * ((turned - c_deg + 180.0) % 360.0 - 180.0)
    # Half a step of J4; J1 and J2 alone stand up to 60 mdeg beside their commands.
    assert np.abs(off_mdeg).max() < 0.6


def test_every_line_is_one_that_a_controller_takes() -> None:
    text = melfa_program(compensated([-200.0, 0.0, 100.0, 99.0]), ORIGIN, SETTINGS)
    assert text.isascii()
    lines = text.split("\r\n")
    assert lines.pop() == ""
    for number, line in enumerate(lines, 1):
        first, _, statement = line.partition(" ")
        assert int(first) == number
        assert len(line) <= 127
        assert re.fullmatch(
            r"'.*|Ovrd 20|Cnt 0|JC=\((-?\d+\.\d{3},){3}-?\d+\.\d{3}\)|Mov JC|Dly 0\.50|End", statement
        ), line
    assert "MOVES A REAL ARM" in lines[0]
    assert any("Gr??e.json" in line for line in lines)
    assert sum("take-up" in line and "before row" in line for line in lines) == 2


def test_a_short_settling_becomes_the_shortest_delay() -> None:
    text = melfa_program(compensated([0.0]), ORIGIN, replace(SETTINGS, settle_time_s=0.0))
    assert "Dly 0.05" in text


def test_a_program_of_too_many_lines_is_refused() -> None:
    with pytest.raises(UsageError, match="split the path into several files"):
        melfa_program(compensated(np.linspace(-100.0, 100.0, 8200).tolist()), ORIGIN, SETTINGS)

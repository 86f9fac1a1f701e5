"""States of approach and take-ups of a corrected path, on arms whose corrections can be worked out by hand."""

import math

import numpy as np
import pytest

from catseye.app.errors import LimitError
from catseye.app.results.scara.compensation import CompensatedPath, compensate_path, require_limits
from catseye.app.results.scara.path_csv import CommandPath, ToolWish, cartesian_commands
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.calibration.scara.layout import Layout
from catseye.calibration.scara.planar import forward
from catseye.calibration.scara.points import Commands
from catseye.procedures.scara.tool_zero import ToolZero

NOMINAL = (325.0, 225.0)
NODES = [-170.0, 170.0]


def arm(up1: float, down1: float, up2: float = 0.0, down2: float = 0.0) -> IdentifiedArm:
    """Return an arm of nominal links whose maps are constant, mdeg, one value for each direction."""
    mdeg = [up1, up1, down1, down1, up2, up2, down2, down2]
    parameters = np.array([*NOMINAL, *np.radians(1e-3 * np.array(mdeg))])
    layout = Layout("error-map", np.deg2rad(NODES), np.deg2rad(NODES), (), ())
    return IdentifiedArm(layout, parameters, np.zeros((10, 10)))


def positions(theta_deg: list[tuple[float, float]]) -> CommandPath:
    """Return a path of positions, those of the nominal arm at joint angles."""
    theta = np.deg2rad(theta_deg)
    place = forward(theta[:, 0], theta[:, 1], *NOMINAL)
    return CommandPath(cartesian_commands(place, NOMINAL, "right", (1, 1)), place, cartesian=True)


def joints(rows: list[tuple[float, float, int, int]]) -> CommandPath:
    columns = np.array(rows)
    theta, states = np.deg2rad(columns[:, :2]), columns[:, 2:].astype(np.int64)
    commands = Commands(theta[:, 0], theta[:, 1], states[:, 0], states[:, 1])
    return CommandPath(commands, forward(theta[:, 0], theta[:, 1], *NOMINAL), cartesian=False)


def lines_of(theta_deg: list[tuple[float, float]], numbers: list[int], tool: ToolWish) -> CommandPath:
    """Return the same in several lines, each entered in its own direction, with height and orientation."""
    theta, line = np.deg2rad(theta_deg), np.array(numbers)
    place = forward(theta[:, 0], theta[:, 1], *NOMINAL)
    commands = cartesian_commands(place, NOMINAL, "right", None, line)
    return CommandPath(commands, place, cartesian=True, numbers=line, tool=tool)


def corrections_mdeg(path: CompensatedPath) -> Floats:
    corrected: Floats = 1e3 * np.rad2deg(path.correction_rad)
    return corrected


def test_each_state_has_its_own_correction() -> None:
    path = positions([(0.0, 60.0), (10.0, 60.0), (20.0, 60.0), (15.0, 60.0), (5.0, 60.0)])
    found = compensate_path(arm(-8.0, 12.0), path, NOMINAL, 1.0)
    assert corrections_mdeg(found)[:, 0] == pytest.approx([8.0, 8.0, 8.0, -12.0, -12.0], abs=1e-6)
    assert found.solution.commands.direction1.tolist() == [1, 1, 1, -1, -1]
    # The first row is approached from anywhere; the reversal goes farther than the take-up.
    assert found.take_up[:, 0].tolist() == [True, False, False, False, False]
    assert not found.contradicted.any()


def test_a_reversal_by_less_than_the_take_up_needs_one() -> None:
    path = positions([(0.0, 60.0), (10.0, 60.0), (9.5, 60.0), (9.0, 60.0), (8.5, 60.0)])
    found = compensate_path(arm(-8.0, 12.0), path, NOMINAL, 1.0)
    assert found.take_up[:, 0].tolist() == [True, False, True, False, False]
    take_ups = [stop.theta1_deg for stop in found.stops if stop.command is None]
    assert take_ups == pytest.approx([0.008 - 1.0, 9.5 - 0.012 + 1.0])
    # Standing on the other flank, J1 is off by the reversal error of 20 mdeg at the radius of the arm.
    radius = math.hypot(*path.command_mm[2])
    assert found.loose_mm[2] == pytest.approx(radius * math.radians(0.020), rel=1e-3)
    assert found.loose_mm[3] == 0.0


def test_the_states_are_those_of_the_corrected_path() -> None:
    """Along a straight line J1 turns back at another place once the links are the true ones."""
    y_mm = np.arange(-335.0, -315.0, 0.05)
    place = np.column_stack([np.full(y_mm.size, 200.0), y_mm])
    path = CommandPath(cartesian_commands(place, NOMINAL, "right", (-1, 1)), place, cartesian=True)
    longer = arm(0.0, 0.0)
    longer.parameters[:2] = [325.4, 224.7]
    found = compensate_path(longer, path, NOMINAL, 1.0)
    corrected = found.solution.commands
    assert corrected.direction1[1:].tolist() == np.sign(np.diff(corrected.theta1_rad)).tolist()
    assert corrected.direction2[1:].tolist() == np.sign(np.diff(corrected.theta2_rad)).tolist()
    assert np.any(corrected.direction1 != path.commands.direction1)
    assert not found.contradicted.any()


def test_a_step_no_state_fits_is_marked_contradicted() -> None:
    """Approached from below the arm stands ahead: turning back by 5 mdeg takes a command 15 mdeg higher."""
    path = positions([(0.0, 60.0), (10.0, 60.0), (9.995, 60.0)])
    found = compensate_path(arm(10.0, -10.0), path, NOMINAL, 1.0)
    # From above: −5 mdeg, and +20 mdeg of reversal; the step goes up, so the state is from below; then it goes down.
    assert found.contradicted[2, 0]
    assert found.take_up[2, 0]
    states = found.solution.commands.direction1
    offset = -10.0 if states[2] > 0 else 10.0
    assert corrections_mdeg(found)[2, 0] == pytest.approx(offset, abs=1e-6)


def test_joint_commands_keep_their_states() -> None:
    path = joints([(0.0, 60.0, 1, 1), (10.0, 50.0, -1, -1), (10.0, 50.0, 1, -1)])
    found = compensate_path(arm(-8.0, 12.0, -3.0, 5.0), path, NOMINAL, 1.0)
    assert corrections_mdeg(found) == pytest.approx(
        np.array([[8.0, 3.0], [-12.0, -5.0], [8.0, -5.0]]), abs=1e-6
    )
    assert found.contradicted.tolist() == [[False, False], [True, False], [False, False]]
    assert found.take_up.tolist() == [[True, True], [True, False], [True, False]]


def test_what_steps_of_a_millidegree_leave() -> None:
    path = joints([(10.0004, 60.0, 1, 1)])
    found = compensate_path(arm(0.0, 0.0), path, NOMINAL, 1.0)
    radius = math.hypot(*path.command_mm[0])
    assert found.sent_deg.tolist() == [[10.0, 60.0]]
    assert found.rounding_mm[0] == pytest.approx(radius * math.radians(0.0004), rel=1e-6)
    assert np.abs(found.shift_mm).max() < 1e-9


def test_rows_without_a_correction_are_no_stops() -> None:
    path = joints([(0.0, 60.0, 1, 1), (171.0, 60.0, 1, 1), (20.0, 60.0, 1, 1)])
    found = compensate_path(arm(5.0, 5.0), path, NOMINAL, 1.0)
    assert found.solution.solved.tolist() == [True, False, True]
    assert [stop.command.index for stop in found.stops if stop.command] == [0, 2]


def test_commands_and_take_ups_keep_the_limits() -> None:
    path = joints([(0.0, 60.0, 1, 1), (-89.5, 60.0, 1, 1)])
    found = compensate_path(arm(5.0, 5.0), path, NOMINAL, 1.0)
    require_limits(found, {"J1": (-91.0, 90.0), "J2": (0.0, 140.0)}, [2, 3])
    with pytest.raises(LimitError, match=r"line 3: the take-up before it needs J1 = -90\.505°"):
        require_limits(found, {"J1": (-90.0, 90.0), "J2": (0.0, 140.0)}, [2, 3])
    with pytest.raises(LimitError, match=r"line 3: the corrected command needs J1 = -89\.505°"):
        require_limits(found, {"J1": (-89.0, 90.0), "J2": (0.0, 140.0)}, [2, 3])


def test_the_first_row_outside_the_limits_is_named() -> None:
    path = joints([(0.0, 60.0, 1, 1), (80.0, 60.0, 1, 1), (85.0, 60.0, 1, 1)])
    with pytest.raises(LimitError, match=r"line 3: "):
        require_limits(
            compensate_path(arm(5.0, 5.0), path, NOMINAL, 1.0),
            {"J1": (-90.0, 70.0), "J2": (0.0, 140.0)},
            [2, 3, 4],
        )


def test_each_line_begins_with_a_take_up_on_its_side() -> None:
    theta = [(0.0, 60.0), (10.0, 60.0), (20.0, 60.0), (10.0, 60.0), (0.0, 60.0)]
    found = compensate_path(arm(-8.0, 12.0), lines_of(theta, [1, 1, 2, 2, 2], ToolWish()), NOMINAL, 1.0)
    assert corrections_mdeg(found)[:, 0] == pytest.approx([8.0, 8.0, -12.0, -12.0, -12.0], abs=1e-6)
    assert found.take_up[:, 0].tolist() == [True, False, True, False, False]
    take_ups = [stop.theta1_deg for stop in found.stops if stop.command is None]
    assert take_ups == pytest.approx([0.008 - 1.0, 20.0 - 0.012 + 1.0])
    # The way from line to line is no step of the path.
    assert not found.contradicted.any()


@pytest.mark.parametrize("sign", [1, -1])
def test_the_tool_keeps_height_and_orientation(sign: int) -> None:
    tool = ToolWish(np.array([40.0, 45.0, 50.0]), np.array([80.0, 85.0, 90.0]))
    path = lines_of([(0.0, 60.0), (10.0, 60.0), (20.0, 60.0)], [1, 1, 1], tool)
    zero = ToolZero(z_mm=10.0, c_deg=-5.0, z_sign=sign, c_sign=sign)
    found = compensate_path(arm(-8.0, 12.0, 3.0, 3.0), path, NOMINAL, 1.0, zero)
    corrected = found.solution.commands
    assert found.j4_deg is not None
    assert found.sent_j4_deg is not None
    assert found.j3_mm is not None
    # Upwards J1 stands 8 mdeg below its command and J2 3 mdeg above: the tool turns by both.
    turned = np.rad2deg(corrected.theta1_rad + corrected.theta2_rad) - 0.008 + 0.003
    assert turned + sign * found.j4_deg - 5.0 == pytest.approx([80.0, 85.0, 90.0], abs=1e-9)
    assert found.sent_deg.sum(axis=1) - 0.005 + sign * found.sent_j4_deg == pytest.approx(
        [85.0, 90.0, 95.0], abs=1e-9
    )
    assert 10.0 + sign * found.j3_mm == pytest.approx([40.0, 45.0, 50.0])


def test_a_turned_tool_keeps_near_the_middle_of_its_range() -> None:
    # The orientation jumps by a turn in the file, and J4 does not.
    tool = ToolWish(c_deg=np.array([355.0, 358.0, 1.0, 4.0]))
    path = lines_of([(10.0, 60.0), (10.0, 60.5), (10.0, 61.0), (10.0, 61.5)], [1] * 4, tool)
    found = compensate_path(arm(0.0, 0.0), path, NOMINAL, 1.0)
    assert found.j4_deg == pytest.approx([-75.0, -72.5, -70.0, -67.5])


def test_limits_of_the_tools_joints_are_kept() -> None:
    tool = ToolWish(np.array([40.0, 61.0]), np.array([80.0, 170.0]))
    found = compensate_path(arm(0.0, 0.0), lines_of([(0.0, 60.0), (10.0, 60.0)], [1, 1], tool), NOMINAL, 1.0)
    wide = {"J1": (-90.0, 90.0), "J2": (0.0, 140.0), "J3": (0.0, 150.0), "J4": (-360.0, 360.0)}
    require_limits(found, wide, [2, 3])
    with pytest.raises(LimitError, match=r"line 3: .* needs J3 = 61\.000 mm, outside .*another z_mm"):
        require_limits(found, wide | {"J3": (40.0, 60.0)}, [2, 3])
    with pytest.raises(LimitError, match=r"line 3: .* needs J4 = 100\.000°, outside .*another c_deg"):
        require_limits(found, wide | {"J4": (-90.0, 90.0)}, [2, 3])

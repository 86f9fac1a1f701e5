"""The covariance of predictions against rotations and cosines written down here."""

import math
from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import IDENTIFIED, Budget, Contributor
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.calibration.scara.layout import Layout
from catseye.calibration.scara.points import Commands
from catseye.calibration.scara.prediction import predict
from catseye.calibration.scara.prediction_errors import position_errors
from tests.unit.calibration.scara.paper import NODES1_DEG, NODES2_DEG

LAYOUT = Layout("error-map", np.deg2rad(NODES1_DEG), np.deg2rad(NODES2_DEG), (), ())
PARAMETERS = np.concatenate([[325.0, 225.0], np.zeros(LAYOUT.arm_size - 2)])
ANGLES = [(-133.0, 27.0), (-90.5, 51.0), (10.0, 70.0), (44.0, 113.0)]
COMMANDS = Commands(
    np.deg2rad([one for one, _ in ANGLES]),
    np.deg2rad([two for _, two in ANGLES]),
    np.ones(4, dtype=np.int64),
    np.ones(4, dtype=np.int64),
)
ROWS = range(len(ANGLES))


def arm(*contributors: Contributor) -> IdentifiedArm:
    nothing = np.zeros((LAYOUT.arm_size, LAYOUT.arm_size))
    return IdentifiedArm(LAYOUT, PARAMETERS, nothing, Budget(contributors))


def covariance(*contributors: Contributor) -> Floats:
    errors = position_errors(arm(*contributors), COMMANDS)
    return np.asarray(errors.effects_mm @ errors.effects_mm.T + np.diag(errors.white_mm2))


def rotation(angle_deg: float) -> Floats:
    cosine, sine = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return np.array([[cosine, -sine], [sine, cosine]])


def in_step(i: int, j: int, joint: int, orders: int) -> float:
    """Return the correlation of a motion with evenly shared harmonics at two of the angles."""
    apart = math.radians(ANGLES[i][joint] - ANGLES[j][joint])
    return sum(math.cos(order * apart) for order in range(1, orders + 1)) / orders


def assert_blocks(found: Floats, expected: dict[tuple[int, int], Floats]) -> None:
    for (i, j), block in expected.items():
        np.testing.assert_allclose(found[2 * i : 2 * i + 2, 2 * j : 2 * j + 2], block, atol=1e-15)


def test_an_arm_that_does_not_repeat_scatters() -> None:
    found = covariance(Contributor("repeatability", "position", 0.010))
    np.testing.assert_allclose(found, np.eye(8) * 1e-4, atol=1e-18)


def test_arrivals_that_are_averaged_scatter_less() -> None:
    errors = position_errors(arm(Contributor("repeatability", "position", 0.010)), COMMANDS, arrivals=4)
    assert errors.white_mm2 == pytest.approx(np.full(8, 0.25e-4))


def test_the_first_axis_moves_in_the_frame_of_the_base() -> None:
    found = covariance(Contributor("J1", "radial", 0.005, "axis-angle", "j1", orders=3))
    blocks = {(i, j): 0.005**2 * in_step(i, j, 0, 3) * np.eye(2) for i in ROWS for j in ROWS}
    assert_blocks(found, blocks)


def test_the_second_axis_moves_in_the_frame_of_link_1() -> None:
    found = covariance(Contributor("J2", "radial", 0.005, "axis-angle", "j2"))
    frames = [rotation(one) for one, _ in ANGLES]
    blocks = {(i, j): 0.005**2 * in_step(i, j, 1, 5) * frames[i] @ frames[j].T for i in ROWS for j in ROWS}
    assert_blocks(found, blocks)


def test_the_axis_of_a_resting_tool_moves_with_link_2() -> None:
    found = covariance(Contributor("J4", "radial", 0.010, "axis-angle", "j4"))
    frames = [rotation(one + two) for one, two in ANGLES]
    assert_blocks(found, {(i, j): 1e-4 * frames[i] @ frames[j].T for i in ROWS for j in ROWS})


def test_what_lies_between_nodes_turns_arm_or_link_2() -> None:
    u = math.radians(0.002)
    once = np.ones(1, dtype=np.int64)
    at_mid = Commands(np.deg2rad([-110.0]), np.deg2rad([90.0]), once, once)
    for axis, centre in (("j1", 0.0 + 0.0j), ("j2", 325.0 * np.exp(1j * math.radians(-110.0)))):
        contributor = Contributor("ripple", "between-nodes", u, "axis-angle", "j1" if axis == "j1" else "j2")
        errors = position_errors(arm(contributor), at_mid)
        tip = 325.0 * np.exp(1j * math.radians(-110.0)) + 225.0 * np.exp(1j * math.radians(-20.0))
        lever = 1j * (tip - centre)
        found = errors.effects_mm @ errors.effects_mm.T
        # Half way between nodes the ripple counts with 1 + 1/4 + 1/4; some of its orders are in step with the nodes.
        size = float(np.trace(found)) / (u * abs(lever)) ** 2
        assert size == pytest.approx(1.5, rel=0.15)
        direction = np.array([lever.real, lever.imag]) / abs(lever)
        np.testing.assert_allclose(found, np.trace(found) * np.outer(direction, direction), atol=1e-15)


def test_errors_of_the_instrument_are_none_of_the_arm() -> None:
    instrument = (
        Contributor("wavelength", "scale", 1e-6, "common"),
        Contributor("environment", "length", 0.010),
        Contributor("beam", "direction", 1e-3),
    )
    assert not np.any(covariance(*instrument))


def test_predictions_have_the_blocks_of_the_whole_covariance() -> None:
    contributors = (
        Contributor("ripple of J1", "between-nodes", 3e-5, "axis-angle", "j1"),
        Contributor("ripple of J2", "between-nodes", 5e-5, "axis-angle", "j2"),
        Contributor("J2", "radial", 0.005, "axis-angle", "j2"),
    )
    whole = covariance(*contributors).reshape(len(ANGLES), 2, len(ANGLES), 2)
    blocks = predict(arm(*contributors), COMMANDS, 325.0, 225.0).covariance_mm2
    np.testing.assert_allclose(blocks, whole[ROWS, :, ROWS, :], rtol=1e-9, atol=1e-18)


def test_every_part_is_named_and_they_add_up() -> None:
    known = arm(
        Contributor("repeatability", "position", 0.010),
        Contributor("J2", "radial", 0.005, "axis-angle", "j2"),
        Contributor("ripple", "between-nodes", 3e-5, "axis-angle", "j1"),
    )
    known = replace(known, covariance=np.diag(np.full(LAYOUT.arm_size, 1e-10)))
    found = predict(known, COMMANDS, 325.0, 225.0)
    assert set(found.parts_mm2) == {IDENTIFIED, "repeatability", "J2", "ripple"}
    total = np.sum(list(found.parts_mm2.values()), axis=0)
    assert total == pytest.approx(np.sum(found.u_mm**2, axis=1))


def test_without_a_budget_the_parameters_alone_count() -> None:
    alone = IdentifiedArm(LAYOUT, PARAMETERS, np.diag(np.full(LAYOUT.arm_size, 1e-10)))
    found = predict(alone, COMMANDS, 325.0, 225.0)
    assert set(found.parts_mm2) == {IDENTIFIED}

"""Compensation value lists: the manuals' worked example, and a controller that is written down here."""

import math

import numpy as np
import pytest

from catseye.app.errors import UsageError
from catseye.app.results.scara.compensated_path import Origin
from catseye.app.results.scara.ssfk_table import maps_of, ssfk_table
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.error_map import BidirectionalMap
from catseye.calibration.scara.extension import Term
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.calibration.scara.layout import Layout

ORIGIN = Origin(
    "result.json",
    "error-map",
    "mean of theta1 map = 0",
    (325.0312, 224.9876),
    (325.0, 225.0),
    "2026-01-01",
    "catseye",
    "2026-01-02",
)


def entries(text: str) -> dict[str, str]:
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    return dict(line.split() for line in lines)


def column(found: dict[str, str], name: str) -> list[int]:
    count = int(found["kw.ssfk.kw_nr_max"])
    return [int(found[f"kw.ssfk.table[{i}].{name}"]) for i in range(count)]


def joint_map(nodes: list[float], up_mdeg: list[float], down_mdeg: list[float]) -> BidirectionalMap:
    return BidirectionalMap(
        np.deg2rad(nodes), np.radians(1e-3 * np.array(up_mdeg)), np.radians(1e-3 * np.array(down_mdeg))
    )


def test_the_sign_is_that_of_the_worked_example() -> None:
    """Their axis is sent to 19866.7 µm and stands at 19856.5 and 19874.7: values −102 and 80 tenths of a µm.

    As angles in 0.0001°: command 19.8667°, actual 19.8565° from below and 19.8747° from above.
    """
    up, down = 1e3 * (19.8565 - 19.8667), 1e3 * (19.8747 - 19.8667)
    table = joint_map([0.0, 19.8667, 40.0], [0.0, up, 0.0], [0.0, down, 0.0])
    found = entries(ssfk_table(1, table, ORIGIN))
    assert column(found, "setpoint")[1] == 198667
    assert column(found, "pos")[1] == -102
    assert column(found, "neg")[1] == 80
    assert [found[f"kw.ssfk.{name}"] for name in ("interval", "unit", "bilateral", "modulo")] == list("0110")
    assert found["kw.ssfk.kw_startpos"] == "0"


def test_a_controller_with_the_list_leaves_no_deviation() -> None:
    nodes, up, down = [-140.0, -60.0, 15.5, 60.0], [12.0, -8.0, 20.0, 3.0], [25.0, 4.0, 33.0, 18.0]
    found = entries(ssfk_table(2, joint_map(nodes, up, down), ORIGIN))
    assert (found["kopf.achs_nr"], found["kopf.log_achs_name"]) == ("2", "J2")
    points = [value / 1e4 for value in column(found, "setpoint")]
    for command in np.linspace(-139.0, 59.0, 67):
        for name, deviations in (("pos", up), ("neg", down)):
            # The controller takes the position error, linear between the points, off the set point.
            set_point = command - np.interp(command, points, column(found, name)) / 1e4
            actual = set_point + 1e-3 * np.interp(set_point, nodes, deviations)
            # Half a unit of 0.0001°, and the map read at the set point instead of the command.
            assert abs(actual - command) < 0.5e-4 + 1e-3 * 33.0 * 1e-3 * 28.0 / 44.5


def test_comments_state_source_gauge_sign_and_links() -> None:
    text = ssfk_table(1, joint_map([0.0, 10.0], [1.0, 2.0], [3.0, 4.0]), ORIGIN)
    comments = "\n".join(line for line in text.splitlines() if line.startswith("#"))
    for remark in (
        "result.json",
        "mean of theta1 map = 0",
        "actual minus command",
        "325.0312 and 224.9876 mm",
    ):
        assert remark in comments


@pytest.mark.parametrize("nodes", [np.arange(1500.0) / 100.0, np.array([0.0, 0.00001, 1.0])])
def test_more_points_than_a_list_takes_are_refused(nodes: Floats) -> None:
    zeros = np.zeros(nodes.size)
    with pytest.raises(UsageError, match="identify with fewer nodes"):
        ssfk_table(1, BidirectionalMap(np.deg2rad(nodes), zeros, zeros), ORIGIN)


def test_what_a_table_cannot_hold_is_refused() -> None:
    conventional = Layout("conventional", np.zeros(0), np.zeros(0), (), ())
    with pytest.raises(UsageError, match="put it and the identified links into the controller's kinematics"):
        maps_of(IdentifiedArm(conventional, np.array([325.0, 225.0, 0.0]), np.zeros((3, 3))))
    nodes = np.deg2rad([0.0, 90.0])
    crosstalk = Layout("error-map", nodes, nodes, (), (), (Term("theta2", "theta1", "cos"),))
    with pytest.raises(UsageError, match=r"cannot hold Δθ2 cos θ1"):
        maps_of(IdentifiedArm(crosstalk, np.zeros(11), np.zeros((11, 11))))


def test_the_maps_are_those_of_the_arm() -> None:
    nodes1, nodes2 = np.deg2rad([0.0, 90.0]), np.deg2rad([0.0, 60.0, 120.0])
    layout = Layout("error-map", nodes1, nodes2, (), (), (Term("link1", "elapsed", "linear"),))
    parameters = np.array([325.0, 225.0, *range(1, 11), 0.5])
    first, second = maps_of(IdentifiedArm(layout, parameters, np.zeros((13, 13))))
    assert (first.positive_rad.tolist(), first.negative_rad.tolist()) == ([1.0, 2.0], [3.0, 4.0])
    assert (second.positive_rad.tolist(), second.negative_rad.tolist()) == ([5.0, 6.0, 7.0], [8.0, 9.0, 10.0])
    assert math.degrees(second.nodes_rad[2]) == pytest.approx(120.0)

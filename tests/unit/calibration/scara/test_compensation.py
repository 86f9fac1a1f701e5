"""The model turned round, against a forward model that is written down here with plain trigonometry."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from catseye.calibration.core.errors import ConvergenceError
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.compensation import Compensation, compensate
from catseye.calibration.scara.extension import Term
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.calibration.scara.layout import Layout
from catseye.calibration.scara.points import Commands

NODES1 = [-140.0 + 20.0 * i for i in range(11)]
NODES2 = [-140.0 + 20.0 * i for i in range(15)]


def interpolated(nodes: list[float], values: list[float], theta_deg: float) -> float:
    """Return a table's value between its nodes."""
    for (low, high), (one, two) in zip(pairwise(nodes), pairwise(values), strict=True):
        if low <= theta_deg <= high:
            return one + (two - one) * (theta_deg - low) / (high - low)
    raise AssertionError(theta_deg)


class PlainArm:
    """An arm of two links with tables in mdeg by node, and crosstalk as an amplitude of sin θ2 on joint 1, mdeg."""

    def __init__(self, seed: int, spread_mdeg: float = 12.0, crosstalk_mdeg: float = 0.0) -> None:
        rng = np.random.default_rng(seed)
        self.link1, self.link2 = (nominal + float(rng.normal(0.0, 0.03)) for nominal in (325.0, 225.0))
        self.tables1 = {s: rng.normal(0.0, spread_mdeg, len(NODES1)).tolist() for s in (1, -1)}
        self.tables2 = {s: rng.normal(0.0, spread_mdeg, len(NODES2)).tolist() for s in (1, -1)}
        self.crosstalk = crosstalk_mdeg

    def place(self, theta1_deg: float, theta2_deg: float, s1: int, s2: int) -> tuple[float, float]:
        a = theta1_deg + 1e-3 * interpolated(NODES1, self.tables1[s1], theta1_deg)
        a += 1e-3 * self.crosstalk * math.sin(math.radians(theta2_deg))
        b = a + theta2_deg + 1e-3 * interpolated(NODES2, self.tables2[s2], theta2_deg)
        one, both = math.radians(a), math.radians(b)
        return (
            self.link1 * math.cos(one) + self.link2 * math.cos(both),
            self.link1 * math.sin(one) + self.link2 * math.sin(both),
        )

    def identified(self) -> IdentifiedArm:
        terms = (Term("theta1", "theta2", "sin"),) if self.crosstalk else ()
        tables = [*self.tables1[1], *self.tables1[-1], *self.tables2[1], *self.tables2[-1]]
        mdeg = [*tables, self.crosstalk] if terms else tables
        parameters = np.array([self.link1, self.link2, *np.radians(1e-3 * np.array(mdeg))])
        layout = Layout("error-map", np.deg2rad(NODES1), np.deg2rad(NODES2), (), (), terms)
        return IdentifiedArm(layout, parameters, np.diag(np.full(parameters.size, 1e-8)))


def commands_of(theta_deg: Floats, states: Ints) -> Commands:
    theta = np.deg2rad(theta_deg)
    return Commands(theta[:, 0], theta[:, 1], states[:, 0], states[:, 1])


def nominal_place(theta_deg: Floats) -> Floats:
    a, b = np.deg2rad(theta_deg[:, 0]), np.deg2rad(theta_deg.sum(axis=1))
    return np.column_stack([325.0 * np.cos(a) + 225.0 * np.cos(b), 325.0 * np.sin(a) + 225.0 * np.sin(b)])


def missed_mm(arm: PlainArm, solution: Compensation) -> float:
    """Return the largest distance of the plain arm from where it shall stand."""
    c = solution.commands
    found = [
        arm.place(math.degrees(one), math.degrees(two), int(s1), int(s2))
        for one, two, s1, s2 in zip(c.theta1_rad, c.theta2_rad, c.direction1, c.direction2, strict=True)
    ]
    return float(np.abs(np.array(found) - solution.wished_mm).max())


@settings(max_examples=60)
@given(seed=st.integers(0, 10**6), spread=st.floats(0.0, 300.0), crosstalk=st.sampled_from([0.0, 8.0]))
def test_the_corrected_command_stands_where_it_shall(seed: int, spread: float, crosstalk: float) -> None:
    arm = PlainArm(seed, spread, crosstalk)
    rng = np.random.default_rng(seed)
    side = rng.choice([-1.0, 1.0], 40)
    theta = np.column_stack([rng.uniform(-138.0, 58.0, 40), side * rng.uniform(4.0, 138.0, 40)])
    states = rng.choice([-1, 1], (40, 2))
    solution = compensate(arm.identified(), commands_of(theta, states), nominal_place(theta))
    assert solution.solved.all()
    assert missed_mm(arm, solution) < 1e-9
    # The elbow stays: a solution through the other one would be tens of degrees away.
    assert np.abs(np.rad2deg(solution.commands.theta2_rad) - theta[:, 1]).max() < 5.0


@settings(max_examples=60)
@given(
    seed=st.integers(0, 10**6),
    offset_mdeg=st.floats(-40.0, 40.0),
    node1=st.integers(1, len(NODES1) - 2),
    node2=st.integers(1, len(NODES2) - 2).filter(lambda i: abs(NODES2[i]) > 1.0),
)
def test_next_to_the_kinks_at_the_nodes(seed: int, offset_mdeg: float, node1: int, node2: int) -> None:
    arm = PlainArm(seed, 100.0)
    theta = np.array([[NODES1[node1] + 1e-3 * offset_mdeg, NODES2[node2] - 1e-3 * offset_mdeg]])
    solution = compensate(arm.identified(), commands_of(theta, np.array([[1, -1]])), nominal_place(theta))
    assert missed_mm(arm, solution) < 1e-9


@pytest.mark.parametrize(("slope_mdeg", "most"), [(1.0, 5), (10.0, 7), (100.0, 13)])
def test_the_number_of_steps_is_as_stated(slope_mdeg: float, most: int) -> None:
    arm = PlainArm(1)
    # A saw whose teeth rise and fall by the slope, the largest change there is.
    saw = [10.0 * slope_mdeg * (-1) ** i for i in range(len(NODES2))]
    arm.tables1 = {s: saw[: len(NODES1)] for s in (1, -1)}
    arm.tables2 = dict.fromkeys((1, -1), saw)
    grid = np.array(
        [[one, two] for one in np.arange(-130.0, 55.0, 7.3) for two in np.arange(11.0, 130.0, 7.9)]
    )
    states = np.ones(grid.shape, dtype=np.int64)
    solution = compensate(arm.identified(), commands_of(grid, states), nominal_place(grid))
    assert missed_mm(arm, solution) < 1e-9
    # The last step confirms the one before.
    assert solution.steps <= most


def test_turns_of_joint_1_stay() -> None:
    arm = PlainArm(2)
    identified = arm.identified()
    nodes1 = identified.layout.nodes1_rad + 2.0 * math.pi
    wound = IdentifiedArm(
        Layout("error-map", nodes1, identified.layout.nodes2_rad, (), ()),
        identified.parameters,
        identified.covariance,
    )
    theta = np.array([[-30.0 + 360.0, 50.0]])
    solution = compensate(wound, commands_of(theta, np.array([[1, 1]])), nominal_place(theta))
    assert math.degrees(solution.commands.theta1_rad[0]) == pytest.approx(330.0, abs=0.2)


def test_beyond_the_nodes_and_beyond_reach_there_is_no_number() -> None:
    arm = PlainArm(3)
    arm.tables1 = {s: [15.0] * len(NODES1) for s in (1, -1)}
    # The second row lies on the outermost node and would have to go 15 mdeg beyond it.
    theta = np.array([[0.0, 40.0], [-140.0, 40.0], [0.0, 41.0], [0.0, 42.0]])
    wished = nominal_place(theta)
    wished[2] = [560.0, 0.0]
    wished[3] = [60.0, 0.0]
    solution = compensate(arm.identified(), commands_of(theta, np.ones((4, 2), dtype=np.int64)), wished)
    assert solution.reachable.tolist() == [True, True, False, False]
    assert solution.inside.tolist() == [True, False, False, False]
    assert solution.solved.tolist() == [True, False, False, False]
    assert np.isnan(solution.commands.theta1_rad[1:]).all()
    assert np.isnan(solution.u_mm[1:]).all()


def test_nearly_stretched_it_still_stands_there() -> None:
    arm = PlainArm(4)
    arm.link1, arm.link2 = 325.03, 225.02
    # The nominal arm is stretched; the true one, 50 µm longer, has to bend by degrees.
    theta = np.array([[10.0, 0.0], [10.0, 1e-4], [10.0, -1e-4], [10.0, 0.5]])
    solution = compensate(
        arm.identified(), commands_of(theta, np.ones((4, 2), dtype=np.int64)), nominal_place(theta)
    )
    assert solution.solved.all()
    assert missed_mm(arm, solution) < 1e-9
    bend = np.rad2deg(solution.commands.theta2_rad)
    # 0.05 mm of reach by the law of cosines: cos θ2 = 1 − 0.05·550/(325·225), θ2 = 1.57°.
    assert np.abs(bend[:3]) == pytest.approx(1.57, abs=0.05)
    assert np.sign(bend).tolist() == [1.0, 1.0, -1.0, 1.0]


def test_the_uncertainty_is_that_of_the_position() -> None:
    arm = PlainArm(5)
    identified = arm.identified()
    only_link1 = np.zeros_like(identified.covariance)
    only_link1[0, 0] = 0.004**2
    theta = np.array([[0.0, 90.0], [-90.0, 90.0]])
    known = IdentifiedArm(identified.layout, identified.parameters, only_link1)
    solution = compensate(known, commands_of(theta, np.ones((2, 2), dtype=np.int64)), nominal_place(theta))
    # Link 1 lies along x in the first row and along y in the second one.
    assert solution.u_mm[0] == pytest.approx([0.004, 0.0], abs=4e-6)
    assert solution.u_mm[1] == pytest.approx([0.0, 0.004], abs=4e-6)


def test_a_conventional_arm_turns_its_offset_round() -> None:
    theta20 = math.radians(-5.55e-3)
    layout = Layout("conventional", np.zeros(0), np.zeros(0), (), ())
    arm = IdentifiedArm(layout, np.array([325.0, 225.0, theta20]), np.zeros((3, 3)))
    theta = np.array([[200.0, 60.0]])
    solution = compensate(arm, commands_of(theta, np.array([[1, 1]])), nominal_place(theta))
    assert math.degrees(solution.commands.theta1_rad[0]) == pytest.approx(200.0, abs=1e-10)
    assert math.degrees(solution.commands.theta2_rad[0]) == pytest.approx(60.00555, abs=1e-10)


def test_a_map_as_steep_as_the_angle_is_refused() -> None:
    arm = PlainArm(6)
    arm.tables2 = {s: [(-1) ** i * 10_500.0 for i in range(len(NODES2))] for s in (1, -1)}
    theta = np.array([[0.0, 30.0]])
    with pytest.raises(ConvergenceError, match="nearly as fast as the angle"):
        compensate(arm.identified(), commands_of(theta, np.array([[1, 1]])), nominal_place(theta))

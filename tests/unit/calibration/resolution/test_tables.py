"""Look-up between sectors and steps, and nothing beyond."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.resolution.tables import (
    Curve,
    ExpectedErrors,
    JointTable,
    ResolutionTables,
    Sector,
)

STEPS = np.array([1e-4, 1e-3, 1e-2])


def sector(position: float, level: float, reversal: float | None = None, commands: object = STEPS) -> Sector:
    sizes = np.asarray(commands, dtype=np.float64)
    rising = level * np.arange(float(sizes.size))
    return Sector(position, sizes, ExpectedErrors(-rising, rising, 0.1 * rising), reversal)


def curve(table: JointTable, position: float) -> Curve:
    found = table.curve(position)
    assert found is not None
    return found


TABLE = JointTable("A1", 1, (sector(-30.0, 10.0, 0.004), sector(30.0, 40.0, 0.006)))


@given(st.floats(-30.0, 30.0), st.floats(-4.0, -2.0))
def test_errors_are_linear_in_log_step_and_position(position: float, log_step: float) -> None:
    level = 25.0 + 0.5 * position
    found = curve(TABLE, position).at(np.array([10.0**log_step]))
    assert found.mean_percent[0] == pytest.approx(-level * (log_step + 4.0), abs=1e-6)
    assert found.scatter_percent[0] == pytest.approx(level * (log_step + 4.0), abs=1e-6)
    assert found.u_mean_percent[0] == pytest.approx(0.1 * level * (log_step + 4.0), abs=1e-6)


def test_steps_beyond_the_table_have_no_error() -> None:
    found = curve(TABLE, 0.0).at(np.array([0.99e-4, 1e-4, 1e-2, 1.01e-2]))
    assert np.isnan(found.mean_percent).tolist() == [True, False, False, True]


@pytest.mark.parametrize(("position", "known"), [(-31.5, False), (-30.9, True), (30.9, True), (31.5, False)])
def test_positions_hold_as_far_as_a_test_moves(position: float, known: bool) -> None:
    assert (TABLE.curve(position) is not None) == known


def test_reversal_is_between_those_of_the_sectors() -> None:
    assert curve(TABLE, 15.0).reversal == pytest.approx(0.0055)


def test_reversal_that_one_sector_lacks_is_not_known() -> None:
    table = JointTable("A1", 1, (sector(-30.0, 10.0, 0.004), sector(30.0, 40.0)))
    assert curve(table, 15.0).reversal is None


def test_only_steps_that_both_sectors_know_are_known_between() -> None:
    table = JointTable("A1", 1, (sector(-30.0, 1.0), sector(30.0, 1.0, commands=[1e-3, 1e-1])))
    found = curve(table, 0.0)
    assert (found.smallest, found.largest) == (1e-3, 1e-2)


def test_sectors_without_a_common_step_are_refused() -> None:
    with pytest.raises(ArgumentError, match="no step in common"):
        JointTable("A1", 1, (sector(-30.0, 1.0), sector(30.0, 1.0, commands=[1e-1, 1.0])))


def test_two_tables_of_one_direction_are_refused() -> None:
    with pytest.raises(ArgumentError, match="two tables"):
        ResolutionTables([TABLE, TABLE])


@pytest.mark.parametrize("commands", [[1e-3, 1e-4], [0.0, 1e-3], [-1e-3, 1e-3], []])
def test_commands_have_to_be_positive_and_increasing(commands: list[float]) -> None:
    with pytest.raises(ArgumentError, match="commands"):
        sector(0.0, 1.0, commands=commands)

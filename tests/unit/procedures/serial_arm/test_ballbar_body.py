"""The bar's own body on its way: boxes in its way, at commands and between them."""

from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.kinematics.bodies import Box
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.serial_arm.ballbar_body import require_clear_bar
from catseye.procedures.serial_arm.bench import SerialBench
from tests.unit.procedures.serial_arm.benches import SIX
from tests.unit.procedures.serial_arm.test_ballbar import BENCH, CUP, plan_of
from tests.unit.procedures.six_axes import CHAIN

NEST = SIX.target("N1")


def nest_mm(command: object) -> np.ndarray:
    flange = CHAIN.flange(np.array([command]))[0]
    return np.asarray((flange @ [*NEST.place_mm, 1.0])[:3])


def with_box(middle: np.ndarray) -> SerialBench:
    low, high = middle - 5.0, middle + 5.0
    box = Box("post", (low[0], low[1], low[2]), (high[0], high[1], high[2]))
    return replace(BENCH, workspace=replace(BENCH.workspace, keep_out=(box,)))


def test_what_stands_in_the_bars_way_is_named() -> None:
    (path,) = plan_of().paths
    assert BENCH.ballbar is not None
    middle = 0.5 * (CUP + nest_mm(path.commands[20]))
    with pytest.raises(PlanError, match="keep-out box post comes within"):
        require_clear_bar(with_box(middle), BENCH.ballbar, NEST, path.commands)


def test_a_box_that_is_met_between_commands_only() -> None:
    (path,) = plan_of().paths
    assert BENCH.ballbar is not None
    ends = path.commands[0], path.commands[-1]
    between = np.mean(ends, axis=0)
    bench = with_box(CUP + 0.75 * (nest_mm(between) - CUP))
    for one in ends:
        require_clear_bar(bench, BENCH.ballbar, NEST, (one,))
    with pytest.raises(PlanError, match="keep-out box post"):
        require_clear_bar(bench, BENCH.ballbar, NEST, ends)


def test_a_clear_way_is_driven() -> None:
    (path,) = plan_of().paths
    assert BENCH.ballbar is not None
    require_clear_bar(BENCH, BENCH.ballbar, NEST, path.commands)

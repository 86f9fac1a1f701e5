"""One cat's eye that is carried from nest to nest."""

from dataclasses import replace

import numpy as np
import pytest

from catseye.simulators.errors import BenchError
from catseye.simulators.world.bench import Bench
from tests.unit.simulators.benches import P1, P2, QUIET, aimed, go, quiet_bench

CARRIED = replace(QUIET, reflectors=(P2, P1), one_reflector=True)


def at_p2() -> Bench:
    bench = quiet_bench(CARRIED)
    go(bench, aimed(20.0, 30.0))
    assert bench.beam.zero()
    return bench


def test_at_the_start_the_first_nest_is_occupied() -> None:
    bench = quiet_bench(CARRIED)
    assert bench.beam.in_place == ["P2"]
    assert quiet_bench().beam.in_place == ["P1", "P2", "P3"]


def test_an_empty_nest_neither_returns_nor_counts_as_nearest() -> None:
    bench = quiet_bench(CARRIED)
    go(bench, aimed(20.0, 30.0, P1))
    insight = bench.true_state()
    assert (insight.reflector, insight.nearest) == (None, "P2")
    bench.beam.place_reflector("P1")
    assert bench.true_state().reflector == "P1"


def test_removing_and_replacing_a_reflector_loses_the_beam() -> None:
    bench = at_p2()
    bench.beam.place_reflector("P1")
    assert not bench.beam.read().returns
    assert not bench.beam.zero()
    bench.beam.place_reflector("P2")
    assert bench.beam.read().returns
    assert bench.beam.read().beam_lost


def test_a_reflector_that_is_in_place_is_left_alone() -> None:
    bench = at_p2()
    bench.beam.place_reflector("P2")
    assert not bench.beam.read().beam_lost
    bench.beam.place_reflector("all")
    assert bench.beam.in_place == ["P2", "P1"]
    assert not bench.beam.read().beam_lost
    assert bench.beam.read().displacement_mm == 0.0


def test_a_nest_holds_the_reflector_to_some_micrometres() -> None:
    bench = quiet_bench(CARRIED)
    lengths = []
    for _ in range(600):
        bench.beam.place_reflector("P1")
        bench.beam.place_reflector("P2")
        # The straight arm looks along +X: 680 mm - 550 mm, and the scatter along x.
        lengths.append(bench.true_state().length_mm - 130.0)
    # 600 draws: the standard deviation is known to 2.9 %.
    assert np.std(lengths) == pytest.approx(0.002, rel=0.1)
    assert abs(np.mean(lengths)) < 0.0004


def test_a_moved_nest_stays_where_it_was_moved_to() -> None:
    bench = quiet_bench(replace(CARRIED, nest_um=0.0))
    bench.beam.move_reflector("P2", 3.0, 0.0)
    bench.beam.place_reflector("P1")
    bench.beam.place_reflector("P2")
    assert bench.true_state().length_mm == pytest.approx(133.0)


def test_an_unknown_nest_is_refused_and_nothing_is_carried() -> None:
    bench = at_p2()
    with pytest.raises(BenchError, match="no reflector 'P9'; there are P2, P1"):
        bench.beam.place_reflector("P9")
    assert bench.beam.in_place == ["P2"]
    assert not bench.beam.read().beam_lost

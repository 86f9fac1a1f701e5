"""Interferometers take rates from their own counts: the noise of those shows, and nothing does without a beam."""

import math
import struct
from collections.abc import Callable

import numpy as np
import pytest

from catseye.simulators.context import EmulationContext
from catseye.simulators.ports.session import Session
from catseye.simulators.world.counter import RATE_S
from tests.unit.simulators.truth.worlds import BUDGET, assert_unsure, heard, said, session_of, world

NOISE_MM_S = math.sqrt(2.0) * 1e-3 * BUDGET.counter_noise_um / RATE_S
READINGS = 60
PROTOCOLS = ("line-counter", "lasertex-hpi")


def rates_of_a_line_counter(context: EmulationContext, session: Session) -> list[float]:
    return [float(said(context, session, b"V\r").split()[0]) for _ in range(READINGS)]


def rates_of_an_hpi(context: EmulationContext, session: Session) -> list[float]:
    said(context, session, bytes.fromhex("AAB0340000000006"))
    streamed = heard(context, session, READINGS * 0.04 + 0.01)
    frames = [streamed[n : n + 16] for n in range(0, 16 * READINGS, 16)]
    assert {frame[1:3] for frame in frames} == {b"\xb0\x16"}
    return [1e-4 * float(struct.unpack(">i", frame[3:7])[0]) for frame in frames]


READ: dict[str, Callable[[EmulationContext, Session], list[float]]] = {
    "line-counter": rates_of_a_line_counter,
    "lasertex-hpi": rates_of_an_hpi,
}


@pytest.mark.parametrize("protocol", READ)
def test_a_rate_at_rest_scatters_as_counts_do(protocol: str) -> None:
    context = world()
    rates = READ[protocol](context, session_of(context, protocol))
    assert_unsure(rates, NOISE_MM_S)


@pytest.mark.parametrize("protocol", READ)
def test_without_a_beam_there_is_no_rate(protocol: str) -> None:
    context = world()
    context.bench.block_beam(None)
    assert set(READ[protocol](context, session_of(context, protocol))) == {0.0}


def test_a_rate_in_motion_differs_from_the_true_one() -> None:
    context = world()
    session = session_of(context, "line-counter")
    bench = context.beam_bench
    j1, j2, j3, j4 = bench.joints
    bench.move_to((j1 + 0.5, j2, j3, j4 - 0.5), 1.0)
    bench.advance(0.5 * (bench.standstill_s - bench.time_s))
    true_mm_s = bench.velocity_mm_s()
    assert abs(true_mm_s) > 0.1
    errors = np.array(rates_of_a_line_counter(context, session)) - true_mm_s
    assert_unsure(errors.tolist(), NOISE_MM_S)

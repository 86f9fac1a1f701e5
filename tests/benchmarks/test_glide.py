"""What one cycle of real-time control costs the emulated bench, against bare looks at its beam."""

import time

import numpy as np

from catseye.simulators.config import EmulationConfig
from catseye.simulators.world.bench import Bench
from catseye.simulators.world.scara.arm import scara_bench
from catseye.simulators.world.scara.truth import draw_truth
from tests.unit.simulators.benches import P1, P2, P3, aimed

CYCLE_S = 0.0071
CYCLES = 250
ROUNDS = 4
TARGET_S = 0.5e-3
MOST = 30.0
"""A glide may cost so many bare looks; it takes four itself, and each of its cycles is a motion of its own."""


def glides_s(bench: Bench, first: int) -> float:
    """Return what a cycle takes, s of CPU."""
    # 14 deg/s of J1 with the beam aimed: four looks at the beam a cycle.
    targets = [aimed(0.02 * k, 30.0) for k in range(first, first + CYCLES)]
    began_s = time.process_time()
    for target in targets:
        bench.glide(target, CYCLE_S)
        bench.advance_to(bench.standstill_s)
    return (time.process_time() - began_s) / CYCLES


def looks_s(bench: Bench) -> float:
    """Return what a bare look at the beam takes while the arm rests, s of CPU."""
    now = np.array([bench.time_s])
    began_s = time.process_time()
    for _ in range(CYCLES):
        bench.beam.look(now)
    return (time.process_time() - began_s) / CYCLES


def test_a_glide_costs_few_looks_at_the_beam() -> None:
    config = EmulationConfig(reflectors=(P1, P2, P3), seed=5, start_joints=aimed(0.0, 30.0))
    bench = scara_bench(draw_truth(5, config), config)
    taken = [(glides_s(bench, 1 + CYCLES * done), looks_s(bench)) for done in range(ROUNDS)]
    each_s, look_s = (min(column) for column in zip(*taken, strict=True))
    print(  # noqa: T201  # the figure
        f"\n{1e3 * each_s:.2f} ms of CPU for a glide of 7.1 ms (target {1e3 * TARGET_S:g} ms), a bare look at the "
        f"beam {1e3 * look_s:.3f} ms: {each_s / look_s:.1f} × (limit {MOST:g} ×)"
    )
    assert each_s <= MOST * look_s

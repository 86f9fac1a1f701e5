"""Angular and linear optics beside a serial arm: noise, air, tripods and prisms keep the truth to themselves."""

import numpy as np
import pytest

from catseye.simulators.config import ArmOptics
from catseye.simulators.emulated_bench import EmulatedSerialBench
from catseye.simulators.world.types import Floats
from tests.unit.simulators.truth.test_serial_arms import GOAL, kuka
from tests.unit.simulators.truth.worlds import assert_unsure, said, session_of

OPTICS = ArmOptics()
SEEDS = range(12)
READINGS = 60


def mounted(kind: str, seed: int) -> EmulatedSerialBench:
    emulation = kuka(seed)
    if kind == "angular":
        emulation.bench.beam.mount_angular(1)
    else:
        emulation.bench.beam.mount_linear((1.0, 0.0, 0.0))
    return emulation


def read_mm(emulation: EmulatedSerialBench, count: int = 1) -> Floats:
    """Read a counter that shows lengths in full; the line counter has six digits behind the point."""
    session = session_of(emulation.context, "lasertex-hpi", "hpi")
    frames = []
    for _ in range(count):
        said(emulation.context, session, bytes.fromhex("AAB032000000008E"))
        emulation.bench.advance(0.041)
        frames.append(session.output()[:16])
    return np.array([1e-7 * int.from_bytes(frame[3:10], "big", signed=True) for frame in frames])


@pytest.mark.parametrize("kind", ["angular", "linear"])
def test_readings_at_rest_are_noisy_and_wander(kind: str) -> None:
    emulation = mounted(kind, 3)
    jumps_nm = 1e6 * np.diff(read_mm(emulation, READINGS))
    assert_unsure(jumps_nm.tolist(), float(np.sqrt(2.0)) * OPTICS.noise_nm, 3.0 * OPTICS.noise_nm)


def test_an_angle_has_the_scale_of_prisms_that_nobody_knows() -> None:
    errors = []
    for seed in SEEDS:
        emulation = mounted("angular", seed)
        first_mm, before = read_mm(emulation)[0], emulation.bench.true_joints
        emulation.bench.move_to((GOAL[0] + 2.0, *GOAL[1:]), 10.0)
        emulation.bench.advance(20.0)
        sine = abs(read_mm(emulation)[0] - first_mm) / OPTICS.spacing_mm
        errors.append(float(sine / np.sin(np.deg2rad(emulation.bench.true_joints[0] - before[0])) - 1.0))
    # The air's index, 2.7e-4, is in the count; the prisms add theirs.
    assert_unsure((np.array(errors) - 2.7e-4).tolist(), 0.8 * OPTICS.u_spacing_mm / OPTICS.spacing_mm, 8e-4)

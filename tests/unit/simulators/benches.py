"""Small benches for the tests: everything known, everything random off unless asked for."""

import math
from dataclasses import replace

import numpy as np

from catseye.calibration.scara.error_map import BidirectionalMap
from catseye.simulators.config import EmulationConfig, ErrorBudget, Joints, ReflectorPlace
from catseye.simulators.world.bench import Bench
from catseye.simulators.world.scara.arm import scara_bench
from catseye.simulators.world.scara.axis_errors import JointMap
from catseye.simulators.world.scara.truth import TrueArm

P1 = ReflectorPlace("P1", 650.0, -400.0)
P2 = ReflectorPlace("P2", 680.0, 0.0)
P3 = ReflectorPlace("P3", 640.0, 380.0)

QUIET = EmulationConfig(
    reflectors=(P1, P2, P3), budget=ErrorBudget.none(), beam_offset_mm=0.0, beam_pitch_mrad=0.0
)
"""The paper's layout without any error."""


def constant_map(positive_mdeg: float = 0.0, negative_mdeg: float = 0.0) -> JointMap:
    """Return a map that is the same everywhere."""
    to_rad = math.pi / 180e3
    return JointMap(np.zeros(1), np.array([positive_mdeg * to_rad]), np.array([negative_mdeg * to_rad]))


def calibration_map(table: JointMap) -> BidirectionalMap:
    """Return a true map as the calibration reads it."""
    return BidirectionalMap(table.nodes_rad, table.positive_rad, table.negative_rad)


def perfect_arm(config: EmulationConfig = QUIET) -> TrueArm:
    """Return the nominal arm with the reflectors where the configuration has them."""
    places = {place.name: (place.x_mm, place.y_mm) for place in config.reflectors}
    return TrueArm(config.scara.link1_mm, config.scara.link2_mm, constant_map(), constant_map(), places)


def without_j4_play(config: EmulationConfig) -> EmulationConfig:
    """Return the configuration with a J4 that points exactly."""
    return replace(config, scara=replace(config.scara, j4_backlash_mdeg=0.0))


def quiet_bench(config: EmulationConfig = QUIET, truth: TrueArm | None = None) -> Bench:
    """Return a bench of the nominal arm, J4 without play."""
    config = without_j4_play(config)
    return scara_bench(truth or perfect_arm(config), config)


def axis_mm(j1_deg: float, j2_deg: float) -> complex:
    """Return where the J4 axis of the nominal arm is."""
    first = math.radians(j1_deg)
    both = first + math.radians(j2_deg)
    return 325.0 * complex(math.cos(first), math.sin(first)) + 225.0 * complex(math.cos(both), math.sin(both))


def aimed(j1_deg: float, j2_deg: float, place: ReflectorPlace = P2) -> Joints:
    """Return the pose in which the nominal arm points its beam at a reflector, |J4| at most 180 deg."""
    way = complex(place.x_mm, place.y_mm) - axis_mm(j1_deg, j2_deg)
    j4_deg = math.degrees(math.atan2(way.imag, way.real)) - j1_deg - j2_deg
    return (j1_deg, j2_deg, 0.0, math.remainder(j4_deg, 360.0))


def go(bench: Bench, target: Joints, override_percent: float = 20.0) -> None:
    """Move and wait until the arm stands still."""
    bench.move_to(target, override_percent)
    bench.advance_to(bench.standstill_s)


def driven_mm(bench: Bench, target: Joints) -> float:
    """Drive to a target and let a moment pass; return by how much the beam has become longer, mm."""
    before_mm = bench.true_state().length_mm
    go(bench, target)
    bench.advance(0.01)
    return bench.true_state().length_mm - before_mm

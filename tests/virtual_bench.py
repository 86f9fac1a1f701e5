"""The emulated bench of a KUKA in virtual time: series are recorded as fast as their physics can be worked out.

Nothing is asked over a socket and no time passes: what the controller's program does with an order is done here, and
the counter is read at a uniform rate. Plant, optics, drift and noise are those of the emulated bench.
"""

from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from catseye.app.cell.bench import bench_of
from catseye.app.cell.model import Cell
from catseye.app.results.resolution.recorded_series import RecordedSeries
from catseye.app.service.serial.emulation import serial_emulation_config
from catseye.calibration.core.types import Floats
from catseye.procedures.kit.bench import AngularOptics
from catseye.procedures.resolution.campaign_plan import CampaignPlan, Order, Place, Series
from catseye.procedures.resolution.records import Configuration, Move
from catseye.simulators.config import EmulationConfig, Joints, SerialArm
from catseye.simulators.kuka.kinematics import Kinematics
from catseye.simulators.kuka.program import CYCLE_S, MOVE_PERCENT, STEP_PERCENT, line_times_s
from catseye.simulators.kuka.values import single
from catseye.simulators.world.optics import NOBODY
from catseye.simulators.world.serial.arm_beam import ArmBeam
from catseye.simulators.world.serial.driven_arm import DrivenArm
from catseye.simulators.world.serial.truth import ArmTruth, draw_joint_truth

ARM = "kr210-r2700"
CELL = Cell.model_validate(
    {
        "format": "catseye-cell/1",
        "name": "kuka",
        "robot": {
            "driver": "kuka-varproxy",
            "endpoint": "tcp://127.0.0.1:7000",
            "arm": ARM,
            "override_cap_percent": 10.0,
        },
        "angular_optics": {"spacing_mm": 30.0},
        "linear_optics": {},
    }
)
BENCH = bench_of(CELL)

_OVERRIDE = 0.1
"""The cap of the cell, at which the bench runs: a step is 0.1 % of full speed, as in the paper."""

_SETTLING_S = 2.0
_ALIGNMENTS = 3


def emulation(seed: int) -> EmulationConfig:
    """Return the configuration of the bench, as `catseye emulate` makes it."""
    return serial_emulation_config(CELL, 1.0, seed, None)


def arm_truth(seed: int) -> ArmTruth:
    """Return the drivetrains that the bench draws from a seed."""
    return draw_joint_truth(serial_arm(emulation(seed)), seed)


def serial_arm(config: EmulationConfig) -> SerialArm:
    """Return the arm of a bench."""
    if config.serial is None:
        raise ValueError("this bench has no serial arm")
    return config.serial


class VirtualBench:
    """A bench at one place, with optics that are mounted and aligned.

    Args:
        truth: drivetrains of its arm.
        plan: whose place it is.
        seed: of what scatters, drifts and is mounted.
    """

    def __init__(self, truth: ArmTruth, plan: CampaignPlan, place: Place, seed: int) -> None:
        self._plan, self._place = plan, place
        self._config = config = replace(emulation(seed), start_joints=place.pose)
        arm = serial_arm(config)
        self._kinematics = Kinematics(arm)
        self._time_s = 0.0
        self._arm = DrivenArm(arm, truth.joints, place.pose, seed)
        # The air is corrected for.
        self._beam = ArmBeam(self._arm, config, lambda _time_s: 1.0, lambda: self._time_s)
        self._names = [joint.name for joint in arm.joints]
        self._counter = np.random.default_rng([seed, 6])
        self._times_s: list[Floats] = []
        self._lengths_mm: list[Floats] = []
        self._mount()

    def record(self, series: Series) -> RecordedSeries:
        """Record a series after its run-in."""
        for pose in series.run_in:
            self._drive(pose, MOVE_PERCENT)
            self._time_s = self._arm.motion.end_s + _SETTLING_S
        origin_s = self._time_s
        self._times_s, self._lengths_mm = [], []
        self._sample(origin_s, origin_s + self._plan.standstill_s)
        moves = [self._move(series, number, order, origin_s) for number, order in enumerate(series.orders, 1)]
        times_s, lengths_mm = np.concatenate(self._times_s), np.concatenate(self._lengths_mm)
        return RecordedSeries(
            series.step_id.replace("/", "-"),
            asdict(self._configuration(series)) | {"step_id": series.step_id},
            {},
            times_s - origin_s,
            lengths_mm - lengths_mm[0],
            tuple(moves),
        )

    def _mount(self) -> None:
        beam, place = self._beam, self._place
        if place.optics == "angular":
            beam.mount_angular(self._names.index(place.joint) + 1)
        else:
            x, y, z = (float(place.joint == axis) for axis in "XYZ")
            beam.mount_linear((x, y, z))
        for _ in range(_ALIGNMENTS):
            for screw, tilt_mrad in beam.tilts_mrad.items():
                beam.turn_screw(screw, -tilt_mrad / self._config.arm_optics.mrad_per_turn)

    def _move(self, series: Series, number: int, order: Order, origin_s: float) -> dict[str, Any]:
        sent_s, before = self._time_s, self._arm.measured(self._time_s)
        self._step(series, order)
        ended_s = self._arm.motion.end_s
        self._sample(origin_s, ended_s + self._plan.dwell_s)
        axis = None if series.along else self._names.index(self._place.joint)
        # The next order comes behind the reading, not at the same time.
        read_s = self._time_s - CYCLE_S
        return asdict(
            Move(
                recording="series-1",
                joint=self._place.joint,
                number=number,
                sequence=order.sequence,
                command=order.command,
                time_s=sent_s - origin_s,
                ended_s=ended_s - origin_s,
                measured_before=None if axis is None else before[axis],
                measured_after=None if axis is None else self._arm.measured(self._time_s)[axis],
                torque_nm=None if axis is None else self._arm.torques_nm(read_s)[axis],
                torque_s=None if axis is None else read_s - origin_s,
            )
        )

    def _step(self, series: Series, order: Order) -> None:
        """Do what the program on the controller does with an order."""
        if order.target is not None:
            self._drive(order.target, STEP_PERCENT)
        elif series.along is None:
            goal, axis = list(self._commanded()), self._names.index(self._place.joint)
            measured = self._arm.measured(self._time_s)[axis]
            goal[axis] = single(single(measured) + single(order.command))
            self._drive(tuple(goal), STEP_PERCENT)
        else:
            self._lead(order.command * np.array(series.along))

    def _commanded(self) -> Joints:
        return self._arm.motion.joints_at(self._time_s)

    def _drive(self, goal: Joints, percent: int) -> None:
        self._arm.move_to(goal, self._time_s, percent / 100.0 * _OVERRIDE)

    def _lead(self, increment_mm: Floats) -> None:
        start = self._commanded()
        goal = self._kinematics.stepped(self._arm.measured(self._time_s), increment_mm)
        way_mm = float(np.linalg.norm(goal[:3, 3] - self._kinematics.flange(start)[:3, 3]))
        times_s = line_times_s(way_mm, _OVERRIDE)
        knots = self._kinematics.line(start, goal, times_s.size)
        self._arm.follow(times_s, knots, self._time_s)

    def _sample(self, origin_s: float, until_s: float) -> None:
        """Read the counter up to a time, at the multiples of its interval from the origin on."""
        optics, rate_hz = self._config.arm_optics, self._plan.rate_hz
        first = int(np.ceil((self._time_s - origin_s) * rate_hz - 1e-6))
        last = int(np.ceil((until_s - origin_s) * rate_hz - 1e-6))
        times_s = origin_s + np.arange(first, last) / rate_hz
        sight = self._beam.look(times_s)
        if (sight.index == NOBODY).any():
            raise RuntimeError(f"{self._place.joint} at {self._place.name}: the optics lost their beam")
        noise_mm = 1e-6 * optics.noise_nm * self._counter.standard_normal(times_s.size)
        digit_mm = 1e-6 * optics.resolution_nm
        self._times_s.append(times_s)
        self._lengths_mm.append(digit_mm * np.round((sight.length_mm + noise_mm) / digit_mm))
        self._time_s = until_s

    def _configuration(self, series: Series) -> Configuration:
        optics, place = self._plan.optics(self._place), self._place
        angular = optics if isinstance(optics, AngularOptics) else None
        return Configuration(
            recording="series-1",
            test=series.test,
            joint=place.joint,
            position=place.name,
            position_value=place.value,
            direction=series.direction,
            unit=place.unit,
            amplitude=series.amplitude,
            absolute=int(any(order.target is not None for order in series.orders)),
            standstill_from_s=0.0,
            standstill_until_s=self._plan.standstill_s,
            dwell_s=self._plan.dwell_s,
            spacing_mm=None if angular is None else angular.spacing_mm,
            u_spacing_mm=None if angular is None else angular.u_spacing_mm,
            distance_mm=optics.distance_mm,
            moves=len(series.orders),
        )


def recorded(truth: ArmTruth, plan: CampaignPlan, place: Place, seed: int) -> Sequence[RecordedSeries]:
    """Return all series of a place."""
    bench = VirtualBench(truth, plan, place, seed)
    return [bench.record(series) for series in place.series]

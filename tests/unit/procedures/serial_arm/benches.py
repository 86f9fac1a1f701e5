"""A serial arm with three nests on its tool, and a scripted tracker beside it."""

import math
from dataclasses import dataclass, field, fields, replace
from typing import ClassVar

import numpy as np

from catseye.app.engine.devices import Devices, WireRecorder
from catseye.app.engine.host import run_procedure
from catseye.app.engine.operator import Answer
from catseye.app.engine.request import RunOutcome, RunRequest
from catseye.calibration.kinematics.rotations import angles_of
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.errors import HiddenTargetError
from catseye.drivers.roles.tracker import (
    Face,
    Place,
    TargetPoint,
    TargetPose,
    Tracker,
    TrackerAbilities,
)
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.serial_arm.bench import Ballbar, FixedNest, Instrument, SerialBench, ToolTarget
from tests.unit.app.engine.fakes import FakeBench, FakeRobot, identity
from tests.unit.app.engine.given_parts import Willing
from tests.unit.procedures.six_axes import BENCH, CHAIN

STATION_MM = np.array([2300.0, -300.0, 350.0])
"""Where the tracker stands in the frame of the arm's base; its axes are parallel to that."""

NESTS: dict[str, Place] = {
    "W1": (-2000.0, 0.0, -330.0),
    "W2": (-2000.0, 650.0, -330.0),
    "W3": (-2650.0, 650.0, -330.0),
}
"""In the frame of the tracker."""

TARGETS = (
    ToolTarget("N1", (0.0, 0.0, 125.0), (0.0, 0.0, 1.0)),
    ToolTarget("N2", (115.0, 0.0, 215.0), (1.0, 0.0, 0.0)),
    ToolTarget("N3", (0.0, 150.0, 125.0), (0.0, 1.0, 0.0)),
)
SIX = SerialBench(
    **{each.name: getattr(BENCH, each.name) for each in fields(Bench)},
    instrument=Instrument(
        abilities=TrackerAbilities(points=True, two_faces=True),
        base_mm=(-2300.0, 300.0, -350.0),
        base_deg=(0.0, 0.0, 0.0),
        nests=tuple(FixedNest(name, place) for name, place in NESTS.items()),
    ),
    targets=TARGETS,
    ballbar=Ballbar(300.0, 1.0, 0.001, (450.0, 0.0, 200.0)),
)
CMM = replace(SIX, instrument=replace(SIX.instrument, abilities=TrackerAbilities(poses=True)))

TRUE_SHIFT_MM = np.array([1.5, -0.8, 0.6])
"""By which the arm's base stands elsewhere than the cell file says."""


@dataclass
class ScriptedTracker(Tracker):
    """Sees the targets of a perfect arm whose base is a little off.

    Attributes:
        arm: that carries them.
        hidden: how often each name is hidden before it is seen.
        drift_mm: along x, which everything seems to shift by after a number of measurements.
        asked: name and face of every measurement.
        near: places at which targets were looked for, by name.
    """

    abilities: ClassVar[TrackerAbilities] = TrackerAbilities(points=True, poses=True, two_faces=True)

    arm: FakeRobot
    hidden: dict[str, int] = field(default_factory=dict)
    drift_mm: dict[int, float] = field(default_factory=dict)
    face_mm: float = 0.0
    covariance_mm2: Place | None = (0.0, 0.0, 0.0)
    marks: int | None = 30
    base_marks: int | None = None
    u_frame_mm: Place | None = (0.02, 0.02, 0.02)
    u_frame_deg: Place | None = (0.01, 0.02, 0.03)
    asked: list[tuple[str, Face]] = field(default_factory=list)
    near: list[tuple[str, Place | None]] = field(default_factory=list)

    async def connect(self) -> Identity:
        return identity(True)

    async def close(self) -> None:
        """Nothing is open."""

    def place_mm(self, target: str) -> np.ndarray:
        """Return where a target is, as the tracker would measure it without any error."""
        return np.array(NESTS[target]) if target in NESTS else self._on_tool(target)

    async def point(
        self, target: str, dwell_s: float, near_mm: Place | None = None, face: Face = 1
    ) -> TargetPoint:
        assert dwell_s > 0.0
        self.asked.append((target, face))
        self.near.append((target, near_mm))
        if self.hidden.get(target, 0) > 0:
            self.hidden[target] -= 1
            raise HiddenTargetError(f"{target} is turned away")
        place = self.place_mm(target)
        shift = sum(by for after, by in self.drift_mm.items() if len(self.asked) > after)
        place = place + np.array([shift, self.face_mm * (1.0 if face == 1 else -1.0), 0.0])
        return TargetPoint(_triple(place), (0.02, 0.03, 0.04), self.covariance_mm2)

    async def pose(self, target: str, dwell_s: float) -> TargetPose:
        assert dwell_s > 0.0
        self.asked.append((target, 1))
        turn = angles_of(CHAIN.flange(np.array([self.arm.pose]))[0, :3, :3])
        return TargetPose(
            _triple(self._on_tool(target)),
            _triple(turn),
            self.marks,
            self.u_frame_mm,
            self.u_frame_deg,
            self.base_marks,
        )

    def _on_tool(self, target: str) -> np.ndarray:
        place = next(one.place_mm for one in TARGETS if one.name == target)
        flange = CHAIN.flange(np.array([self.arm.pose]))[0]
        return np.asarray((flange @ np.array([*place, 1.0]))[:3] - STATION_MM + TRUE_SHIFT_MM)


def _triple(values: np.ndarray) -> Place:
    x, y, z = (float(value) for value in values)
    assert all(map(math.isfinite, (x, y, z)))
    return x, y, z


@dataclass
class Room(FakeBench):
    """A bench with the arm, the tracker and somebody who answers."""

    asked: list[Prompt] = field(default_factory=list)
    answers: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.robot = FakeRobot(self.clock, pose=(0.0,) * 6)
        self.tracker = ScriptedTracker(self.robot)

    def build(self, record: WireRecorder) -> Devices:
        record("robot", "tx", b"hello\r")
        return Devices(self.robot, tracker=self.tracker)

    async def answer(self, prompt: Prompt) -> Answer:
        self.asked.append(prompt)
        given = self.answers.get(prompt.id) or next(iter(prompt.choices), "yes")
        return Answer(given, "Ada")

    def request_of(self, procedure: Procedure, plan: object, **changes: object) -> RunRequest:
        hands = Willing("tcp://127.0.0.1:1")
        base = self.request(None, driven=SIX.arm, answerer=self.answer, hands=hands, **changes)  # type: ignore[arg-type]  # set next
        return replace(base, procedure=procedure, plan=plan)


async def carried_out(room: Room, procedure: Procedure, plan: object, **changes: object) -> RunOutcome:
    request = room.request_of(procedure, plan, **changes)
    return await run_procedure(request, room.build, room.clock, room.publish, room.install)

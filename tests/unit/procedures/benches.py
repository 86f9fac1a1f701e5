"""The paper's bench written down by hand, geometry of its own, and a context that plays an ideal arm."""

import math
from collections.abc import Awaitable, Callable, Sequence
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from catseye.app.protocol.procedures import procedures
from catseye.calibration.kinematics.bodies import Capsule
from catseye.calibration.kinematics.chain import Chain, Joint
from catseye.drivers.roles.air import AirSample
from catseye.drivers.roles.interferometer import BeamStatus
from catseye.drivers.roles.pose import Axes, Axis, Pose
from catseye.drivers.roles.tracker import Face, Place, Position, TargetPoint, TargetPose
from catseye.procedures.kit.bench import Arm, Timing, Workspace
from catseye.procedures.kit.columns import Columns, TableRule
from catseye.procedures.kit.context import Measurement, Prompt, Stepped
from catseye.procedures.kit.errors import TableFileError
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.mapping import TableMapping
from catseye.procedures.kit.recording import Recording
from catseye.procedures.kit.records import Json, Record, Row, row_of
from catseye.procedures.scara.bench import Optics, Reflector, ScaraBench
from tests.declared_questions import undeclared

LINK1_MM, LINK2_MM = 325.0, 225.0
NODES1_DEG = tuple(-140.0 + 20.0 * i for i in range(11))
NODES2_DEG = tuple(20.0 * i for i in range(8))
PLACES = {"P1": (650.0, -400.0), "P2": (680.0, 0.0), "P3": (640.0, 380.0)}

Floats = NDArray[np.float64]


CHAIN = Chain(
    (
        Joint("J1", "revolute", 0.0, 0.0, 0.0, 0.0, 1.0, -170.0, 170.0),
        Joint("J2", "revolute", 0.0, LINK1_MM, 0.0, 0.0, 1.0, -145.0, 145.0),
        Joint("J3", "prismatic", 0.0, LINK2_MM, 0.0, 200.0, 1.0, 0.0, 150.0),
        Joint("J4", "revolute", 0.0, 0.0, 0.0, 0.0, 1.0, -360.0, 360.0),
    )
)
WORKSPACE = Workspace(
    chain=CHAIN,
    bodies=(
        Capsule("base column", 0, (0.0, 0.0, 0.0), (0.0, 0.0, 416.0), 110.0),
        Capsule("link 1", 1, (0.0, 0.0, 416.0), (LINK1_MM, 0.0, 416.0), 60.0),
        Capsule("link 2", 2, (0.0, 0.0, 416.0), (LINK2_MM, 0.0, 416.0), 60.0),
        Capsule("quill", 3, (0.0, 0.0, 0.0), (0.0, 0.0, 300.0), 15.0),
        Capsule("interferometer head", 4, (-30.0, 0.0, -50.0), (0.0, 0.0, -50.0), 30.0),
    ),
    table_z_mm=0.0,
    stand_radius_mm=15.0,
    clearance_mm=5.0,
)


Range = tuple[float, float]


def scara_axes(
    j1_deg: Range = (-170.0, 170.0),
    j2_deg: Range = (-145.0, 145.0),
    j3_mm: Range = (12.5, 12.5),
    j4_deg: Range = (-360.0, 360.0),
    speeds: tuple[float, float, float] = (420.0, 720.0, 3000.0),
    accelerations: tuple[float, float, float] = (2000.0, 4000.0, 15000.0),
) -> Axes:
    """Return the paper's axes; speeds and accelerations are those of J1, J2, J4."""
    one, two, four = zip(speeds, accelerations, strict=True)
    return (
        Axis("J1", "deg", *j1_deg, *one),
        Axis("J2", "deg", *j2_deg, *two),
        Axis("J3", "mm", *j3_mm, 1100.0),
        Axis("J4", "deg", *j4_deg, *four),
    )


def with_axes(base: ScaraBench, **changes: Any) -> ScaraBench:
    """Return a bench with other axes; see `scara_axes`."""
    return replace(base, arm=replace(base.arm, axes=scara_axes(**changes)))


def bench(
    nodes1_deg: tuple[float, ...] = NODES1_DEG,
    nodes2_deg: tuple[float, ...] = NODES2_DEG,
    places: dict[str, tuple[float, float]] | None = None,
    j4_limits_deg: tuple[float, float] = (-360.0, 360.0),
) -> ScaraBench:
    """Return the paper's bench."""
    reflectors = tuple(
        Reflector(name, x, y, math.degrees(math.atan2(-y, -x)))
        for name, (x, y) in (PLACES if places is None else places).items()
    )
    return ScaraBench(
        name="lab-1",
        arm=Arm(
            axes=scara_axes(j4_deg=j4_limits_deg),
            range_keys=("limits_deg.j1", "limits_deg.j2", "j3_mm or j3_range_mm", "limits_deg.j4"),
            override_percent=20.0,
        ),
        link1_mm=LINK1_MM,
        link2_mm=LINK2_MM,
        j3_mm=12.5,
        workspace=WORKSPACE,
        optics=Optics(
            acceptance_mm=1.0,
            max_miss_mm=0.2,
            field_half_angle_deg=80.0,
            column_radius_mm=110.0,
            column_margin_mm=5.0,
            beam_min_mm=50.0,
            beam_max_mm=5000.0,
            theta40_deg=0.0,
        ),
        timing=Timing(settle_time_s=0.5, dwell_time_s=0.25, readings=4),
        reflectors=reflectors,
        nodes1_deg=nodes1_deg,
        nodes2_deg=nodes2_deg,
        take_up_deg=1.0,
    )


def with_optics(base: ScaraBench, **values: Any) -> ScaraBench:
    """Return a bench with other optics."""
    return replace(base, optics=replace(base.optics, **values))


def arm_xy(theta1_deg: float, theta2_deg: float) -> tuple[float, float]:
    """Return where the J4 axis stands."""
    a, b = math.radians(theta1_deg), math.radians(theta1_deg + theta2_deg)
    return LINK1_MM * math.cos(a) + LINK2_MM * math.cos(b), LINK1_MM * math.sin(a) + LINK2_MM * math.sin(b)


def clearance_mm(start: tuple[float, float], end: tuple[float, float]) -> float:
    """Return the distance of the origin from a straight line between two points."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = math.hypot(dx, dy)
    along = -(start[0] * dx + start[1] * dy) / length
    if along <= 0.0:
        return math.hypot(*start)
    if along >= length:
        return math.hypot(*end)
    return abs(start[0] * dy - start[1] * dx) / length


def miss_along(start: Pose, end: Pose, place: tuple[float, float], parts: int = 60) -> Floats:
    """Return the beam's distance from a place along a straight joint move, zero direction 0, mm."""
    share = np.linspace(0.0, 1.0, parts + 1)
    one, two, _, four = (np.radians(a + share * (b - a)) for a, b in zip(start, end, strict=True))
    x = LINK1_MM * np.cos(one) + LINK2_MM * np.cos(one + two)
    y = LINK1_MM * np.sin(one) + LINK2_MM * np.sin(one + two)
    beam = one + two + four
    ahead = (place[0] - x) * np.cos(beam) + (place[1] - y) * np.sin(beam)
    aside = np.abs((place[1] - y) * np.cos(beam) - (place[0] - x) * np.sin(beam))
    return np.asarray(np.where(ahead > 0.0, aside, np.inf), dtype=np.float64)


STILL_AIR = AirSample(21.5, 1002.0, 44.0)
"""Air that never changes."""


@dataclass
class IdealContext:
    """A context whose arm goes exactly where it is sent.

    Attributes:
        places: where the reflectors really are.
        theta40_deg: the beam's true zero direction.
        acceptance_mm: largest miss at which the beam returns.
        j4_limits_deg: a move beyond them fails the test.
        j4_error_deg: what J4 is wrong by at a pose (J1, J2).
        blocked: poses from which nothing returns.
        breaks_at: numbers of measurements, from 1, before which the count is lost for a moment.
        dark_at: numbers of measurements that see no beam, whatever else holds.
        stored: results of steps that are done.
        answers: answers to prompts by id; a function may act on the bench first.
        pauses: pose and time of each pause.
        files: measured files by name; a text is the complaint about one that cannot be used.
        resumed: the run goes on after an interruption.
        rehearsing: values are those of an ideal bench.
        waited_s: bench seconds that the run was held, or had a question open.
        set_up_lost: somebody has moved what had been set up, before it was resumed.
    """

    places: dict[str, tuple[float, float]] = field(default_factory=lambda: dict(PLACES))
    theta40_deg: float = 0.0
    acceptance_mm: float = 1.0
    j4_limits_deg: tuple[float, float] = (-360.0, 360.0)
    j4_error_deg: Callable[[float, float], float] = lambda _one, _two: 0.0
    blocked: Callable[[Pose], bool] = lambda _pose: False
    breaks_at: set[int] = field(default_factory=set)
    dark_at: set[int] = field(default_factory=set)
    stored: dict[str, Row] = field(default_factory=dict)
    pose: Pose = (0.0, 0.0, 12.5, 0.0)
    moves: list[Pose] = field(default_factory=list)
    rows: list[tuple[str, Row]] = field(default_factory=list)
    events: list[tuple[str, dict[str, Json]]] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    progressed: list[tuple[float, float, str]] = field(default_factory=list)
    prompts: list[Prompt] = field(default_factory=list)
    answers: dict[str, str | Callable[[Prompt], str]] = field(default_factory=dict)
    shown: list[Live] = field(default_factory=list)
    pauses: list[tuple[Pose, float]] = field(default_factory=list)
    files: dict[str, Columns | str] = field(default_factory=dict)
    mountings: list[float] = field(default_factory=list)
    suspensions: list[str] = field(default_factory=list)
    resumed: bool = False
    rehearsing: bool = False
    set_up_lost: bool = False
    waited_s: float = 0.0
    ran: list[str] = field(default_factory=list)
    waits: list[tuple[float, float, int]] = field(default_factory=list)
    zeros: int = 0
    measurements: int = 0
    lost: bool = True
    zero_mm: float = 0.0

    def length_mm(self) -> float | None:
        """Return the length of the returning beam, None when nothing returns."""
        if self.blocked(self.pose):
            return None
        one, two, _, four = self.pose
        x, y = arm_xy(one, two)
        world = math.radians(one + two + four + self.theta40_deg + self.j4_error_deg(one, two))
        for px, py in self.places.values():
            ahead = (px - x) * math.cos(world) + (py - y) * math.sin(world)
            aside = abs((py - y) * math.cos(world) - (px - x) * math.sin(world))
            if ahead > 0.0 and aside <= self.acceptance_mm:
                return math.hypot(px - x, py - y)
        return None

    @property
    def clock_s(self) -> float:
        """Time stands still."""
        return 0.0

    def is_done(self, step_id: str) -> bool:
        """Return whether a step is stored."""
        return step_id in self.stored

    async def step(self, step_id: str, title: str, action: Callable[[], Awaitable[Row]]) -> Row:
        """Run a step once."""
        assert title
        if step_id in self.stored:
            return self.stored[step_id]
        self.ran.append(step_id)
        result = await action()
        self.stored[step_id] = result
        return result

    def record(self, record: Record) -> None:
        """Keep a record as a row with the name of its table."""
        self.rows.append((record.table, row_of(record)))

    async def checkpoint(self) -> None:
        """Nothing stops here."""

    async def move(self, target: Pose) -> None:
        """Stand at the target at once."""
        low, high = self.j4_limits_deg
        assert low <= target[3] <= high, f"J4 {target[3]} outside {low}…{high}"
        self.pose = target
        self.moves.append(target)
        if self.length_mm() is None:
            self.lost = True

    async def follow(self, way: Sequence[Pose]) -> None:
        """Stand at each target."""
        for target in way:
            await self.move(target)

    async def step_axis(self, axis: str, increment: float) -> Stepped:
        """Refuse: open-loop tracking drives to poses."""
        raise AssertionError(f"{axis} was stepped by {increment}")

    async def step_to(self, target: Pose) -> Stepped:
        """Refuse as a step of an axis."""
        raise AssertionError(f"the arm was stepped to {target}")

    async def step_line(self, increment_mm: tuple[float, float, float]) -> Stepped:
        """Refuse as a step of an axis."""
        raise AssertionError(f"the tool was stepped by {increment_mm}")

    async def torques(self) -> tuple[float, ...]:
        """Refuse: it asks for none."""
        raise AssertionError("torques were read")

    def recording(self, name: str, rate_hz: float = 25.0) -> AbstractAsyncContextManager[Recording]:
        """Refuse: it measures at standstill."""
        raise AssertionError(f"{name} was recorded at {rate_hz} Hz")

    async def joints(self) -> Pose:
        """Return the pose."""
        return self.pose

    async def led_joints(self, rehearsed: Pose) -> Pose:
        """Return what is rehearsed: nobody leads the arm."""
        return rehearsed

    async def measure(self, settle_time_s: float, dwell_time_s: float, readings: int) -> Measurement:
        """Return the distance of the ideal arm."""
        self.waits.append((settle_time_s, dwell_time_s, readings))
        self.measurements += 1
        if self.measurements in self.breaks_at:
            self.lost = True
        length = None if self.measurements in self.dark_at else self.length_mm()
        return Measurement(
            displacement_mm=(length or 0.0) - self.zero_mm,
            spread_mm=0.0001,
            readings=readings,
            beam=self._status(length),
            reported=self.pose,
            air=STILL_AIR,
            time_utc="2026-01-02T03:04:05+00:00",
            duration_s=dwell_time_s,
        )

    async def beam(self) -> BeamStatus:
        """Return the state of the beam."""
        return self._status(self.length_mm())

    def _status(self, length_mm: float | None) -> BeamStatus:
        there = length_mm is not None
        return BeamStatus(there, self.lost, overspeed=False, laser_ready=True, signal=0.75 if there else 0.0)

    async def zero(self, dead_path_mm: float) -> None:
        """Begin a new count."""
        length = self.length_mm()
        assert length is None or math.isclose(dead_path_mm, length, abs_tol=2.0)
        self.zeros += 1
        self.lost = length is None
        self.zero_mm = length or 0.0

    async def locate(self, settle_time_s: float, commanded_mm: tuple[float, float]) -> Position:
        """Return the true position, shifted as another instrument's frame is."""
        self.waits.append((settle_time_s, 0.0, 0))
        del commanded_mm
        x, y = arm_xy(self.pose[0], self.pose[1])
        return Position(x + 1000.0, y - 500.0, 0.004)

    async def measure_target(
        self, target: str, settle_time_s: float, dwell_s: float, near_mm: Place | None = None, face: Face = 1
    ) -> TargetPoint:
        """Refuse: a SCARA carries no targets."""
        raise AssertionError(f"{target} is measured: {settle_time_s}, {dwell_s}, {near_mm}, {face}")

    async def measure_frame(self, target: str, settle_time_s: float, dwell_s: float) -> TargetPose:
        """Refuse: a SCARA carries no targets."""
        raise AssertionError(f"{target} is measured: {settle_time_s}, {dwell_s}")

    async def remounted(self, turned_deg: float) -> None:
        """Keep how the interferometer is mounted."""
        self.mountings.append(turned_deg)

    async def pause(self, duration_s: float) -> None:
        """Stand still."""
        self.pauses.append((self.pose, duration_s))

    async def read_table(self, file: str, table: TableRule | TableMapping, rehearsed: Columns) -> Columns:
        """Return what the file holds, or refuse it."""
        assert not isinstance(table, TableRule) or table.holds
        assert len(rehearsed)
        held = self.files[file]
        if isinstance(held, str):
            raise TableFileError(held)
        return held

    async def ask(self, prompt: Prompt, watch: Callable[[], Awaitable[Live]] | None = None) -> str:
        """Give the next scripted answer, after one look at what is watched."""
        self.prompts.append(prompt)
        assert undeclared([prompt], *procedures()) == []
        if watch is not None:
            self.show(await watch())
        answer = self.answers.get(prompt.id)
        assert answer is not None, f"nobody answers {prompt.id}"
        return answer(prompt) if callable(answer) else answer

    def show(self, live: Live) -> None:
        """Keep what was shown."""
        self.shown.append(live)

    async def wait_until(self, reason: str, back: Callable[[], Awaitable[bool]]) -> None:
        """Keep the reason and look until the condition is back."""
        self.suspensions.append(reason)
        for _ in range(100):
            if await back():
                return
        raise AssertionError(f"it never comes back: {reason}")

    async def event(self, kind: str, **data: Json) -> None:
        """Keep an event."""
        self.events.append((kind, data))

    async def warn(self, text: str, **data: Json) -> None:
        """Keep a warning."""
        assert not data
        self.warnings.append(text)

    def progress(self, done: float, total: float, text: str = "") -> None:
        """Keep the progress."""
        self.progressed.append((done, total, text))

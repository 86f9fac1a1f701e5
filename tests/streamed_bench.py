"""The SCARA's bench with all its errors, led by set points, in virtual time: search, then open-loop tracking.

The driver and the controller's real-time control are the real ones and exchange their datagrams in memory; the
R-protocol is scripted. No time passes, so that what the beam misses does not depend on how busy the machine is.
"""

import asyncio
import tomllib
from collections.abc import AsyncIterator, Mapping, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from catseye.app.cell.bench import scara_bench_of
from catseye.app.cell.model import Cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.service.scara.emulation import emulation_config
from catseye.drivers.melfa.mxt.robot import MelfaMxt
from catseye.drivers.melfa.mxt.settings import MxtSettings
from catseye.drivers.melfa.mxt.stream import SetPointStream
from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.melfa.settings import MelfaSettings
from catseye.drivers.roles.interferometer import BeamStatus
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Measurement
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.open_loop.open_loop import OpenLoop, OpenLoopParams
from catseye.procedures.scara.search.reflector_search import ReflectorSearch, SearchParams
from catseye.simulators.config import EmulationConfig, ErrorBudget
from catseye.simulators.melfa.controller import Controller
from catseye.simulators.melfa.mxt import Mxt, MxtOptions, MxtSession
from catseye.simulators.ports.session import Pending
from catseye.simulators.world.counter import Reading
from catseye.simulators.world.scara.arm import scara_bench
from catseye.simulators.world.scara.truth import TrueArm, draw_truth
from tests.unit.drivers.melfa_bench import QUICK
from tests.unit.drivers.melfa_bench import Controller as ScriptedController
from tests.unit.drivers.peers import Peer, StepClock
from tests.unit.procedures.benches import LINK1_MM, LINK2_MM, STILL_AIR, Floats, IdealContext
from tests.unit.simulators.benches import perfect_arm, without_j4_play

OVERRIDE_PERCENT = 20
NODES = {"theta1_deg": [-60.0, -40.0], "theta2_deg": [20.0, 40.0, 60.0]}
"""With three reflectors 72 points at nodes."""


def cell() -> Cell:
    """Return the shipped cell with few nodes and an arm that is led by set points."""
    text = tomllib.loads(TEMPLATE)
    text["robot"] |= {"driver": "melfa-mxt", "mxt_endpoint": "udp://127.0.0.1:10000"}
    text["measurement"] |= NODES
    return Cell.model_validate(text)


def cell_and_config(seed: int) -> tuple[Cell, EmulationConfig]:
    """Return the cell, and its emulated bench with all its errors."""
    described = cell()
    return described, emulation_config(described, 1.0, seed, None)


class Port:
    """Both ends of the real-time port: a datagram is answered at the controller's next cycle of bench time."""

    endpoint = "memory://mxt"

    def __init__(self, arm: "VirtualArm", session: MxtSession) -> None:
        self._arm, self._session = arm, session

    async def open(self) -> None:
        """There is nothing to open."""

    async def close(self) -> None:
        """There is nothing to close."""

    async def write(self, data: bytes) -> None:
        """Hand the controller a datagram."""
        self._session.feed(data)

    async def read(self) -> bytes:
        """Let time pass until the answer comes; one that never comes is waited for."""
        if answer := self._answer():
            return answer
        await asyncio.Event().wait()
        raise AssertionError("nothing ends this wait")

    def send_urgent(self, data: bytes, *, cut: bytes = b"") -> None:
        """Hand the controller a datagram whose answer nobody reads."""
        del cut
        self._session.feed(data)
        self._answer()

    def waiting(self) -> bytes:
        """Nothing comes unasked."""
        return b""

    def fileno(self) -> int:
        """Refuse as a pipe in memory does."""
        raise NotImplementedError

    def note_heal(self, why: str) -> None:
        """Nothing is kept."""

    def _answer(self) -> bytes:
        answer = self._session.answer()
        if not isinstance(answer, Pending):
            return answer or b""
        while (due_s := answer.due()) is not None:
            self._arm.bench.advance_to(due_s)
        reply = answer.reply()
        self._arm.said.at = self._arm.bench.joints
        self._arm.passed.append(self._arm.bench.joints)
        return reply


class VirtualArm:
    """A bench and its controller, with the driver in front of it.

    Args:
        options: of real-time control.
        settings: of the driver.
        truth: true arm; by default drawn from the configuration's seed.
    """

    def __init__(
        self,
        config: EmulationConfig,
        options: MxtOptions,
        settings: dict[str, object],
        truth: TrueArm | None = None,
    ) -> None:
        self.bench = scara_bench(truth or draw_truth(config.seed, config), config)
        controller = Controller(self.bench, config, lambda: None)
        program = Mxt(controller, self.bench, options, lambda: None)
        controller.install(program)
        controller.switch_servo_on()
        self.bench.advance(5.0)
        self.passed: list[Pose] = []
        self.said = ScriptedController()
        self.said.flags, self.said.override = "E0060", str(OVERRIDE_PERCENT)
        self.said.at = self.bench.joints
        self.port = Port(self, MxtSession(program, lambda _text: None))
        self.settings = MxtSettings.model_validate({"quiet_s": 0.001, **settings})

    def go(self, target: Pose) -> None:
        """Interpolate the joints to a target, as the R-protocol's motions do."""
        self.bench.move_to(target, OVERRIDE_PERCENT)
        self.bench.advance_to(self.bench.standstill_s)
        self.said.at = self.bench.joints


class Clock(StepClock):
    """Bench time."""

    def __init__(self, arm: VirtualArm) -> None:
        super().__init__()
        self._arm = arm

    def monotonic_s(self) -> float:
        """Return bench seconds."""
        return self._arm.bench.time_s


@asynccontextmanager
async def driven(arm: VirtualArm) -> AsyncIterator[MelfaMxt]:
    """Connect the driver to the arm."""
    async with Peer(arm.said.answer) as main, Peer(arm.said.answer) as aside:
        r3 = MelfaR3(main.transport, aside.transport, StepClock(), MelfaSettings.model_validate(QUICK))
        stream = SetPointStream(arm.port, Clock(arm), arm.settings, name="robot (MXT)")
        robot = MelfaMxt(r3, stream, arm.settings)
        try:
            await robot.connect()
            yield robot
        finally:
            await robot.close()


@dataclass
class VirtualContext(IdealContext):
    """The context of the procedures on a virtual bench.

    Attributes:
        arm: bench and controller.
        robot: its driver.
        kept_mm: largest miss of each way over which the beam was kept, from its start to the end of the settling.
        following_mm: what the beam missed on the same ways because the joints were not at one place of the way at one
            time, by nominal geometry: the rest of the miss is that of an arm which is not the nominal one.
        aims_mm: where the measurement is aimed; empty while nothing is known.
        led: joint moves are led by set points as the ways are, which takes long.
        rest_mm: the miss that is left when the arm has come to rest at each of these ways' ends.
    """

    arm: VirtualArm = field(kw_only=True)
    robot: MelfaMxt = field(kw_only=True)
    kept_mm: list[float] = field(default_factory=list)
    rest_mm: list[float] = field(default_factory=list)
    following_mm: list[float] = field(default_factory=list)
    aims_mm: dict[str, tuple[float, float]] = field(default_factory=dict)
    led: bool = False

    @property
    def clock_s(self) -> float:
        """Bench time."""
        return self.arm.bench.time_s

    async def joints(self) -> Pose:
        """Return what the driver reports."""
        return await self.robot.joints()

    async def move(self, target: Pose) -> None:
        """Drive to the target, or lead the arm there."""
        if self.led:
            await self.robot.move_joints(target)
        else:
            self.arm.go(target)
        self.moves.append(target)

    async def follow(self, way: Sequence[Pose]) -> None:
        """Lead the arm along the way; take note of what the beam missed."""
        beam = self.arm.bench.beam
        counted, before_mm = not beam.lost, beam.largest_miss_mm
        beam.largest_miss_mm = 0.0
        self.arm.passed.clear()
        await self.robot.follow(way)
        self.arm.bench.advance(0.5)
        beam.observe()
        if self.led and counted and not beam.lost:
            self.kept_mm.append(beam.largest_miss_mm)
            self.rest_mm.append(self.arm.bench.true_state().miss_mm)
            self.following_mm.append(following_mm(np.array([*self.arm.passed, way[-1]]), self.aims_mm))
        beam.largest_miss_mm = max(before_mm, beam.largest_miss_mm)

    async def measure(self, settle_time_s: float, dwell_time_s: float, readings: int) -> Measurement:
        """Read the bench's own counter."""
        self.arm.bench.advance(settle_time_s)
        taken: list[Reading] = []
        for _ in range(readings):
            taken.append(self.arm.bench.beam.read())
            self.arm.bench.advance(dwell_time_s / readings)
        values = [reading.displacement_mm for reading in taken]
        return Measurement(
            displacement_mm=sum(values) / readings,
            spread_mm=0.0001,
            readings=readings,
            beam=_status(taken[-1]),
            reported=await self.joints(),
            air=STILL_AIR,
            time_utc="2026-01-02T03:04:05+00:00",
            duration_s=dwell_time_s,
        )

    async def beam(self) -> BeamStatus:
        """Return what the counter shows."""
        return _status(self.arm.bench.beam.read())

    async def zero(self, dead_path_mm: float) -> None:
        """Zero the counter."""
        assert dead_path_mm > 0.0
        self.zeros += 1
        self.arm.bench.beam.zero()

    async def pause(self, duration_s: float) -> None:
        """Let time pass."""
        self.arm.bench.advance(duration_s)


def _status(reading: Reading) -> BeamStatus:
    return BeamStatus(
        beam_ok=reading.returns,
        beam_lost=reading.beam_lost,
        overspeed=reading.overspeed,
        laser_ready=reading.laser_ready,
        signal=reading.level,
    )


def following_mm(passed: Floats, aims_mm: Mapping[str, tuple[float, float]]) -> float:
    """Return the largest change of the beam's miss along joints that the arm passed, against the last of them.

    Args:
        passed: joints, the last where the way ends, deg and mm, shape (n, 4).
        aims_mm: places that the arm may aim at; the way's is the one that it misses least at its end.
    """
    one, two, _, four = np.radians(passed.T)
    axis = LINK1_MM * np.exp(1j * one) + LINK2_MM * np.exp(1j * (one + two))
    beam = np.exp(1j * (one + two + four))
    found: list[tuple[float, float]] = []
    for x_mm, y_mm in aims_mm.values():
        ahead = complex(x_mm, y_mm) - axis
        off = np.angle(beam / ahead)
        changed = np.sin(off - off[-1]) * np.abs(ahead)
        found.append((abs(float(off[-1])), float(np.abs(changed).max())))
    return min(found)[1]


async def tracked(
    seed: int,
    options: MxtOptions | None = None,
    reflectors: Sequence[str] = (),
    **settings: object,
) -> VirtualContext:
    """Search for the reflectors and measure all points with the search's aim; return what was noted."""
    described, config = cell_and_config(seed)
    bench: ScaraBench = scara_bench_of(described)
    arm = VirtualArm(config, options or MxtOptions(), settings)
    async with driven(arm) as robot:
        context = VirtualContext(arm=arm, robot=robot)
        search = ReflectorSearch()
        await search.run(context, search.plan(bench, SearchParams()))
        found: dict[str, Any] = dict(context.stored["solve"])
        places = {place["name"]: (place["x_mm"], place["y_mm"]) for place in found["reflectors"]}
        aimed = bench.aimed(places, found["theta40_deg"])
        context.led, context.aims_mm = True, places
        measure = OpenLoop()
        await measure.run(context, measure.plan(aimed, OpenLoopParams(reflectors=list(reflectors))))
    return context


async def tracked_without_errors(options: MxtOptions | None = None, **settings: object) -> VirtualContext:
    """Measure to one reflector on a bench without errors, aimed at where it stands; return what was noted."""
    described, config = cell_and_config(0)
    config = without_j4_play(
        replace(config, budget=ErrorBudget.none(), beam_offset_mm=0.0, beam_pitch_mrad=0.0)
    )
    bench: ScaraBench = scara_bench_of(described)
    arm = VirtualArm(config, options or MxtOptions(), settings, perfect_arm(config))
    async with driven(arm) as robot:
        context = VirtualContext(arm=arm, robot=robot, led=True)
        context.aims_mm = {one.name: (one.x_mm, one.y_mm) for one in bench.reflectors}
        measure = OpenLoop()
        await measure.run(context, measure.plan(bench, OpenLoopParams(reflectors=["P2"])))
    return context

"""Benches with an IRB 120 that carries three nests, and a tracker behind its protocol."""

from dataclasses import dataclass, field

import numpy as np

from catseye.simulators.config import EmulatedDevice, EmulationConfig, Joints, Option
from catseye.simulators.emulated_bench import EmulatedSerialBench
from catseye.simulators.emulator import sessions_of
from catseye.simulators.ports.session import Pending, Session
from catseye.simulators.survey import Place, SurveyConfig
from catseye.simulators.world.serial.frames import placed
from tests.unit.simulators.world.serial.arms import exact_truth, serial_arm
from tests.unit.simulators.world.serial.surveyed import EXACT, FORWARD


def tracker_bench(
    protocol: str,
    *,
    options: dict[str, Option] | None = None,
    survey: SurveyConfig = EXACT,
    start: Joints = FORWARD,
    speed: float = 1.0,
) -> EmulatedSerialBench:
    """Return an emulated bench whose arm follows its commands exactly."""
    arm = serial_arm("irb120")
    device = EmulatedDevice("tracker", protocol, options=options or {})
    config = EmulationConfig(
        serial=arm,
        start_joints=start,
        seed=5,
        survey=survey,
        devices=(device,),
        speed=speed,
        truth=exact_truth(arm),
    )
    return EmulatedSerialBench(config, arm)


def near(bench: EmulatedSerialBench, name: str) -> Place:
    """Return where a nest really is in the tracker's frame."""
    times = np.array([bench.bench.time_s])
    places = bench.bench.room.places_mm([name], times)[0]
    x, y, z = placed(bench.bench.tracker.station.into_at(times), places)[0].tolist()
    return x, y, z


@dataclass
class Client:
    """A client without a socket: bytes go to the session, bench time passes, bytes come back."""

    bench: EmulatedSerialBench
    session: Session = field(init=False)

    def __post_init__(self) -> None:
        self.another()

    def another(self) -> None:
        """Connect as a new client."""
        device = self.bench.context.config.devices[0]
        self.session = sessions_of(self.bench.context, device, lambda _text: None)()

    def say(self, data: bytes) -> bytes:
        """Send bytes; return what is answered at once."""
        self.session.feed(data)
        said = b""
        while (answer := self.session.answer()) is not None:
            assert not isinstance(answer, Pending)
            said += answer
        return said

    def wait(self, duration_s: float) -> bytes:
        """Let bench time pass; return what comes meanwhile."""
        until_s = self.bench.bench.time_s + duration_s
        said = b""
        while (due_s := self.session.next_output_s()) is not None and due_s <= until_s:
            self.bench.bench.advance_to(due_s)
            said += self.session.output()
        self.bench.bench.advance_to(until_s)
        return said + self.session.output()

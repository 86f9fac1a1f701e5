"""T2SA, the text interface of SpatialAnalyzer, over TCP (sheet `trackers_ballbar`, section 5)."""

from collections import deque
from collections.abc import Callable

from pydantic import Field

from catseye.simulators.config import EmulatedDevice
from catseye.simulators.context import EmulationContext
from catseye.simulators.emulator import DeviceOptions, Emulator, NewSession, Note
from catseye.simulators.ports.session import Answer, Session
from catseye.simulators.t2sa.application import Application, Measurement
from catseye.simulators.t2sa.commands import LineCutter, parse
from catseye.simulators.t2sa.instruments import Instruments


class T2saSession(Session):
    """Conversation with one client; while a measurement is under way, other commands are answered.

    Args:
        note: called with each command.
    """

    def __init__(self, application: Application, note: Callable[[str], None]) -> None:
        self._application = application
        self._note = note
        self._cutter = LineCutter()
        self._lines: deque[str] = deque()
        self._measurements: list[Measurement] = []

    def feed(self, data: bytes) -> None:
        """Take bytes, cut anywhere."""
        self._lines += self._cutter.feed(data)

    def answer(self) -> Answer | None:
        """Carry out the next command, behind the answer of a measurement that it ends."""
        if not self._lines:
            return None
        line = self._lines.popleft()
        self._note(line[:200])
        said = self._application.carry_out(parse(line))
        if isinstance(said, bytes):
            return self.output() + said
        self._measurements.append(said)
        return b""

    def next_output_s(self) -> float | None:
        """Return when the next measurement is done."""
        return min((one.due_s for one in self._measurements), default=None)

    def output(self) -> bytes:
        """Return the answers of measurements that are done."""
        said = b"".join(one.answer for one in self._measurements if one.answer is not None)
        self._measurements = [one for one in self._measurements if one.answer is None]
        return said


class T2sa(Emulator):
    """SpatialAnalyzer with its instrument, which all clients share; it looks at a serial arm."""

    role = "tracker"
    arm = "serial"

    class Options(DeviceOptions):
        """Options.

        Attributes:
            warm_up_s: how long a laser that was switched on warms.
            point_s: how long a point is measured.
            laser_on: it is on and warm at the start.
        """

        warm_up_s: float = Field(default=60.0, ge=0.0, le=86_400.0)
        point_s: float = Field(default=1.0, gt=0.0, le=600.0)
        laser_on: bool = True

    @classmethod
    def sessions(cls, context: EmulationContext, device: EmulatedDevice, note: Note) -> NewSession:
        """Make the application that all clients share."""
        options = cls.Options.of(device)
        application = Application(
            Instruments(context.serial_bench),
            warm_up_s=options.warm_up_s,
            point_s=options.point_s,
            lit=options.laser_on and device.name not in context.power_back_s,
        )
        return lambda: T2saSession(application, note)

"""The emulated bench with its servers, as one asynchronous context."""

from collections.abc import Callable
from dataclasses import dataclass
from types import TracebackType

from simulators.bench.bench import Bench
from simulators.config import EmulationConfig, ErrorBudget, ReflectorPlace
from simulators.control import ControlSession, Desk
from simulators.counter.session import CounterSession
from simulators.errors import EmulatorError
from simulators.journal import Journal
from simulators.melfa.controller import Controller
from simulators.melfa.session import MelfaSession
from simulators.modbus.air_sensor import AirSensor
from simulators.modbus.protocol import ModbusSession
from simulators.serving import Port
from simulators.timekeeper import TimeKeeper
from simulators.tracker import Tracker
from simulators.truth import TrueArm, draw_truth, load_truth, truth_document

__all__ = [
    "EmulatedBench",
    "EmulationConfig",
    "EmulatorError",
    "ErrorBudget",
    "ReflectorPlace",
    "ServedEndpoint",
]


@dataclass(frozen=True)
class ServedEndpoint:
    """Where a device of the bench answers.

    Attributes:
        device: robot, interferometer, environment or control.
        protocol: melfa-r3, line-counter, modbus-tcp or catseye-control.
        endpoint: `tcp://host:port` with the port that is really used.
    """

    device: str
    protocol: str
    endpoint: str


class EmulatedBench:
    """All emulators of one bench. Use it as an asynchronous context: it listens inside, and is silent after.

    Args:
        config: what to emulate and where to listen.

    Raises:
        EmulatorError: the truth file, the reflectors or an option cannot be used.
    """

    def __init__(self, config: EmulationConfig) -> None:
        _check(config)
        self._truth: TrueArm = (
            draw_truth(config.seed, config) if config.truth is None else load_truth(config.truth, config)
        )
        self.bench = Bench(self._truth, config, lambda text: self.journal.add("robot", "motion", text))
        self.journal = Journal(lambda: self.bench.time_s)
        self.keeper = TimeKeeper(self.bench, config.speed)
        self.controller = Controller(self.bench, config, self.keeper.changed)
        self.sensor = AirSensor(self.bench, config.pressure_register)
        suffix = config.answer_suffix
        self._ports = [
            self._port(
                "robot",
                "melfa-r3",
                config.robot,
                lambda: MelfaSession(self.controller, suffix, self._note("robot")),
            ),
            self._port(
                "interferometer",
                "line-counter",
                config.interferometer,
                lambda: CounterSession(self.bench, self._note("interferometer")),
            ),
            self._port(
                "environment",
                "modbus-tcp",
                config.environment,
                lambda: ModbusSession(self.sensor, self._note("environment")),
            ),
        ]
        ports = {port.device: port for port in self._ports}
        tracker = Tracker(config.seed)
        self.desk = Desk(self.bench, self.controller, self.sensor, tracker, self.keeper, self.journal, ports)
        self._ports.append(
            self._port("control", "catseye-control", config.control, lambda: ControlSession(self.desk))
        )

    @property
    def endpoints(self) -> list[ServedEndpoint]:
        """Where each device answers; final once the context is entered."""
        return [ServedEndpoint(port.device, port.protocol, port.endpoint) for port in self._ports]

    def truth_document(self) -> dict[str, object]:
        """Return the true arm in the result format."""
        return truth_document(self._truth)

    async def __aenter__(self) -> "EmulatedBench":
        try:
            for port in self._ports:
                await port.open()
        except EmulatorError:
            await self._close()
            raise
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        await self._close()

    async def _close(self) -> None:
        for port in self._ports:
            await port.close()

    def _note(self, device: str) -> Callable[[str], None]:
        return lambda text: self.journal.add(device, "request", text)

    def _port(
        self,
        device: str,
        protocol: str,
        endpoint: str,
        session: Callable[[], MelfaSession | CounterSession | ModbusSession | ControlSession],
    ) -> Port:
        return Port(device, protocol, endpoint, self.keeper, session)


def _check(config: EmulationConfig) -> None:
    if not config.reflectors:
        raise EmulatorError("the emulated bench needs at least one reflector")
    if config.speed <= 0.0:
        raise EmulatorError(f"the speed must be above 0, found {config.speed:g}")
    if config.axis_pattern not in {4, 6, 8}:
        raise EmulatorError(f"position answers have 4, 6 or 8 axes, not {config.axis_pattern}")

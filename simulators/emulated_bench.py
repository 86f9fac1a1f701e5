"""The emulated bench with its servers, as one asynchronous context."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from types import TracebackType
from typing import Generic, Self, TypeVar

from catseye.simulators.abb.controller import AbbController
from catseye.simulators.abb.emulators import AbbRws
from catseye.simulators.config import EmulatedDevice, EmulationConfig, Scara, SerialArm
from catseye.simulators.context import EmulationContext, RobotController
from catseye.simulators.control_port.operations import ControlSession, Reach
from catseye.simulators.emulator import NewSession, emulator_of, load_emulator, sessions_of
from catseye.simulators.errors import EmulatorError
from catseye.simulators.kuka.controller import KukaController
from catseye.simulators.melfa.controller import Controller
from catseye.simulators.ports.address import SocketAddress, parse_address
from catseye.simulators.ports.port import Port
from catseye.simulators.world.air_probe import AirSensors
from catseye.simulators.world.journal import Journal
from catseye.simulators.world.scara.arm import scara_bench
from catseye.simulators.world.scara.room import levelled_tracker
from catseye.simulators.world.scara.truth import draw_truth, true_arm, truth_document
from catseye.simulators.world.serial.bench import SerialBench
from catseye.simulators.world.serial.driven_arm import DrivenArm, dynamics_of
from catseye.simulators.world.serial.true_arm import true_serial_arm
from catseye.simulators.world.timekeeper import TimeKeeper
from catseye.simulators.world.tracker import Tracker


@dataclass(frozen=True)
class ServedEndpoint:
    """Where a device of the bench answers.

    Attributes:
        device: its name; control for the control port.
        protocol: what it speaks there; catseye-control for the control port.
        endpoint: as asked for, with the port that is really used.
    """

    device: str
    protocol: str
    endpoint: str


class ServedBench:
    """All emulators of one bench. Use it as an asynchronous context: it listens inside, and is silent after.

    Args:
        context: the bench and what stands on it.

    Raises:
        EmulatorError: a protocol or an option cannot be used.
    """

    def __init__(self, context: EmulationContext) -> None:
        self.context = context
        self.journal = context.journal
        self.keeper = context.keeper
        config = context.config
        self._ports = [self._port(device) for device in config.devices]
        by_name: dict[str, list[Port]] = {}
        for port in self._ports:
            by_name.setdefault(port.device, []).append(port)
        self.reach = Reach(self.context, Tracker(config.seed), by_name)
        self._ports.append(
            Port(
                "control",
                "catseye-control",
                config.control,
                self.keeper,
                lambda: lambda: ControlSession(self.reach),
            )
        )

    @property
    def endpoints(self) -> list[ServedEndpoint]:
        """Where each device answers; final once the context is entered."""
        return [ServedEndpoint(port.device, port.protocol, port.endpoint) for port in self._ports]

    @property
    def open_to_the_network(self) -> list[str]:
        """Endpoints that programs of other computers can reach, as their cell file has them."""
        addresses = [(port.endpoint, parse_address(port.device, port.endpoint)) for port in self._ports]
        return [
            endpoint
            for endpoint, address in addresses
            if isinstance(address, SocketAddress) and not address.is_loopback
        ]

    async def __aenter__(self) -> Self:
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

    def _port(self, device: EmulatedDevice) -> Port:
        def switch_on() -> NewSession:
            return sessions_of(
                self.context, device, lambda text: self.journal.add(device.name, "request", text)
            )

        most = emulator_of(device).most_clients(device)
        return Port(device.name, device.protocol, device.endpoint, self.keeper, switch_on, most_clients=most)


class EmulatedBench(ServedBench):
    """The bench of a SCARA that carries the beam, with its MELFA controller.

    Raises:
        EmulatorError: the truth file, the reflectors, a protocol or an option cannot be used.
    """

    def __init__(self, config: EmulationConfig) -> None:
        _check(config)
        truth = draw_truth(config.seed, config) if config.truth is None else true_arm(config.truth, config)
        journal = Journal(lambda: self.bench.time_s)
        self.bench = scara_bench(truth, config, lambda text: journal.add("robot", "motion", text))
        keeper = TimeKeeper(self.bench, config.speed)
        self.controller = Controller(self.bench, config, keeper.changed)
        air = AirSensors(self.bench, config.seed, config.budget)
        document = truth_document(truth)
        tracker = levelled_tracker(self.bench, config)
        self.bench.beside.append(tracker)
        super().__init__(
            EmulationContext(config, self.bench, document, self.controller, keeper, journal, air, tracker)
        )


AnyController = TypeVar("AnyController", bound=RobotController)


class _DrivenBench(ServedBench, Generic[AnyController]):
    """The bench of a serial arm with drivetrains, and its controller.

    Args:
        config: of the bench.
        arm: that stands on it.
        control: makes the controller.
    """

    def __init__(
        self,
        config: EmulationConfig,
        arm: SerialArm,
        control: Callable[[SerialBench, TimeKeeper], AnyController],
    ) -> None:
        _require_speed(config)
        journal = Journal(lambda: self.bench.time_s)
        truth = true_serial_arm(arm, config)
        plant = DrivenArm(truth.arm, truth.drives.joints, config.start_joints, config.seed, truth.base)
        made = replace(config, survey=replace(config.survey, targets=truth.targets, u_target_mm=0.0))
        self.bench = SerialBench(plant, made, lambda text: journal.add("robot", "motion", text))
        keeper = TimeKeeper(self.bench, config.speed)
        self.controller = control(self.bench, keeper)
        air = AirSensors(self.bench, config.seed, config.budget)
        document, tracker = truth.document(), self.bench.tracker
        super().__init__(
            EmulationContext(config, self.bench, document, self.controller, keeper, journal, air, tracker)
        )


class EmulatedSerialBench(_DrivenBench[KukaController]):
    """The bench of a serial arm with its KUKA controller.

    Args:
        config: of the bench.
        arm: that stands on it.

    Raises:
        EmulatorError: the truth file, a protocol or an option cannot be used.
    """

    def __init__(self, config: EmulationConfig, arm: SerialArm) -> None:
        super().__init__(config, arm, lambda bench, keeper: KukaController(bench, arm, keeper))


class EmulatedAbbBench(_DrivenBench[AbbController]):
    """The bench of a serial arm with its ABB controller.

    Args:
        config: of the bench.
        arm: that stands on it.

    Raises:
        EmulatorError: the arm has not six joints, or the truth file, a protocol or an option cannot be used.
    """

    def __init__(self, config: EmulationConfig, arm: SerialArm) -> None:
        if len(arm.joints) != 6:
            raise EmulatorError(f"{arm.name}: the emulated IRC5 drives arms with six joints only")
        super().__init__(config, arm, lambda bench, keeper: AbbController(bench, arm, keeper))


class EmulatedDrivenScara(_DrivenBench[Controller]):
    """The bench of a SCARA with drivetrains, for small steps, and its MELFA controller.

    Args:
        config: of the bench.
        arm: that stands on it.

    Raises:
        EmulatorError: the arm is no SCARA, or the truth file, a protocol or an option cannot be used.
    """

    def __init__(self, config: EmulationConfig, arm: SerialArm) -> None:
        if [joint.prismatic for joint in arm.joints] != [False, False, True, False]:
            raise EmulatorError(f"{arm.name}: the emulated MELFA controller drives a SCARA only")
        links = Scara(arm.joints[1].a_mm, arm.joints[2].a_mm)
        known = replace(config, scara=links, dynamics=dynamics_of(arm))
        super().__init__(config, arm, lambda bench, keeper: Controller(bench, known, keeper.changed))


def served_bench(config: EmulationConfig) -> ServedBench:
    """Return the bench of the arm that a configuration describes.

    Raises:
        EmulatorError: something of the configuration cannot be used.
    """
    if config.serial is None:
        return EmulatedBench(config)
    robots = [load_emulator(device.protocol) for device in config.devices if device.name == "robot"]
    if any(robot.arm == "scara" for robot in robots):
        return EmulatedDrivenScara(config, config.serial)
    if any(issubclass(robot, AbbRws) for robot in robots):
        return EmulatedAbbBench(config, config.serial)
    return EmulatedSerialBench(config, config.serial)


def _check(config: EmulationConfig) -> None:
    if not config.reflectors:
        raise EmulatorError("the emulated bench needs at least one reflector")
    _require_speed(config)
    if config.axis_pattern not in {4, 6, 8}:
        raise EmulatorError(f"position answers have 4, 6 or 8 axes, not {config.axis_pattern}")


def _require_speed(config: EmulationConfig) -> None:
    if config.speed <= 0.0:
        raise EmulatorError(f"the speed must be above 0, found {config.speed:g}")

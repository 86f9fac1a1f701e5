"""The controller's endpoints: R-protocol, data link and real-time control."""

from typing import Annotated

from pydantic import AfterValidator, Field

from catseye.simulators.config import EmulatedDevice
from catseye.simulators.context import EmulationContext
from catseye.simulators.emulator import DeviceOptions, Emulator, Note
from catseye.simulators.errors import EmulatorError
from catseye.simulators.melfa.choices import Choices
from catseye.simulators.melfa.controller import Controller
from catseye.simulators.melfa.datalink import Datalink, DatalinkSession, NumberFormat
from catseye.simulators.melfa.mxt import Mode, Mxt, MxtOptions, MxtSession
from catseye.simulators.melfa.r_protocol import MelfaSession
from catseye.simulators.ports.session import Session


def _program_name(name: str) -> str:
    if not name.isalnum() or not name.isascii():
        raise ValueError("a program's name has letters and digits")
    return name.upper()


ProgramName = Annotated[str, AfterValidator(_program_name)]


def _controller(context: EmulationContext, device: EmulatedDevice) -> Controller:
    if not isinstance(context.controller, Controller):
        raise EmulatorError(f"{device.name}: the robot of this bench has no MELFA controller")
    return context.controller


class MelfaR3(Emulator):
    """R-protocol over TCP or a serial line.

    Args:
        context: what the emulators of the bench share.
        device: the endpoint and its options.
        note: called with each request.
    """

    role = "robot"
    Options = Choices

    def __init__(self, context: EmulationContext, device: EmulatedDevice, note: Note) -> None:
        self._controller = _controller(context, device)
        if device.options:
            self._controller.choices = Choices.of(device)
        self._note = note
        # On RS-232 requests have a terminator, and answers end with CR (sheet `melfa`, section 1.2).
        self._segments = not device.endpoint.startswith("serial:")
        self._suffix = context.config.answer_suffix if self._segments else "\r"

    def session(self) -> Session:
        """Return the session of a new client."""
        return MelfaSession(self._controller, self._suffix, self._note, segments=self._segments)


class MelfaDatalink(Emulator):
    """The program that serves the data link.

    Args:
        context: what the emulators of the bench share.
        device: the endpoint and its options.
        note: called with each request.
    """

    role = "robot"

    class Options(DeviceOptions):
        """Options.

        Attributes:
            program: name by which RUN starts it.
            number_format: how it prints numbers.
        """

        program: ProgramName = "CATSDL"
        number_format: NumberFormat = "plain"

    def __init__(self, context: EmulationContext, device: EmulatedDevice, note: Note) -> None:
        options = self.Options.of(device)
        controller = _controller(context, device)
        self._program = Datalink(controller, options.program, options.number_format)
        controller.install(self._program)
        self._note = note

    def session(self) -> Session:
        """Return the session of a new client."""
        return DatalinkSession(self._program, self._note)


class MelfaMxt(Emulator):
    """The program that obeys set points in real time.

    Args:
        context: what the emulators of the bench share.
        device: the endpoint and its options.
        note: called with each command but set points.
    """

    role = "robot"
    link = "udp"

    class Options(DeviceOptions):
        """Options; see `MxtOptions`."""

        program: ProgramName = "CATSMXT"
        mxt_mode: Mode = "joint"
        mxt_cycle_ms: float = Field(default=7.1, ge=1.0, le=100.0)
        mxt_filter_ms: float = Field(default=10.0, ge=0.0, le=1000.0)
        mxt_timeout_s: float = 0.5
        mxt_lag_ms: float = 8.0
        mxt_lag_spread_ms: float = 0.2

    def __init__(self, context: EmulationContext, device: EmulatedDevice, note: Note) -> None:
        given = self.Options.of(device)
        options = MxtOptions(
            program=given.program,
            mode=given.mxt_mode,
            cycle_s=given.mxt_cycle_ms / 1e3,
            filter_s=given.mxt_filter_ms / 1e3,
            timeout_s=given.mxt_timeout_s,
            lag_s=given.mxt_lag_ms / 1e3,
            lag_spread_s=given.mxt_lag_spread_ms / 1e3,
        )
        controller = _controller(context, device)
        self._program = Mxt(controller, options, context.keeper.sync)
        controller.install(self._program)
        controller.parameters.preset("MXTTOUT", [str(options.timeout_cycles)])
        self._note = note

    def session(self) -> Session:
        """Return the session of a new client."""
        return MxtSession(self._program, self._note)

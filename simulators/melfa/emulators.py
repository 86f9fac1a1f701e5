"""The controller's endpoints: R-protocol, data link and real-time control."""

from typing import Annotated

from pydantic import AfterValidator, Field

from catseye.simulators.config import EmulatedDevice
from catseye.simulators.context import EmulationContext
from catseye.simulators.emulator import DeviceOptions, Emulator, NewSession, Note
from catseye.simulators.errors import EmulatorError
from catseye.simulators.melfa.choices import Choices
from catseye.simulators.melfa.controller import Controller
from catseye.simulators.melfa.datalink import Datalink, DatalinkSession, NumberFormat
from catseye.simulators.melfa.mxt import Mode, Mxt, MxtOptions, MxtSession
from catseye.simulators.melfa.r_protocol import MelfaSession


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
    """R-protocol over TCP or a serial line."""

    role = "robot"
    Options = Choices

    @classmethod
    def sessions(cls, context: EmulationContext, device: EmulatedDevice, note: Note) -> NewSession:
        """Make the controller's choices; all endpoints lead to one controller."""
        controller = _controller(context, device)
        if device.options:
            controller.choices = Choices.of(device)
        # On RS-232 requests have a terminator, and answers end with CR (sheet `melfa`, section 1.2).
        segments = not device.endpoint.startswith("serial:")
        suffix = context.config.answer_suffix if segments else "\r"
        return lambda: MelfaSession(controller, suffix, note, segments=segments)


class MelfaDatalink(Emulator):
    """The program that serves the data link."""

    role = "robot"

    class Options(DeviceOptions):
        """Options.

        Attributes:
            program: name by which RUN starts it.
            number_format: how it prints numbers.
        """

        program: ProgramName = "CATSDL"
        number_format: NumberFormat = "plain"

    @classmethod
    def sessions(cls, context: EmulationContext, device: EmulatedDevice, note: Note) -> NewSession:
        """Install the program in the controller."""
        options = cls.Options.of(device)
        controller = _controller(context, device)
        program = Datalink(controller, options.program, options.number_format)
        controller.install(program)
        return lambda: DatalinkSession(program, note)


class MelfaMxt(Emulator):
    """The program that obeys set points in real time.

    Only on the bench of an arm that carries a beam: nobody says what servos do of set points that differ by less than
    they resolve, so none of that is emulated.
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
        mxt_holds_early: bool = True

    @classmethod
    def sessions(cls, context: EmulationContext, device: EmulatedDevice, note: Note) -> NewSession:
        """Install the program in the controller."""
        given = cls.Options.of(device)
        options = MxtOptions(
            program=given.program,
            mode=given.mxt_mode,
            cycle_s=given.mxt_cycle_ms / 1e3,
            filter_s=given.mxt_filter_ms / 1e3,
            timeout_s=given.mxt_timeout_s,
            lag_s=given.mxt_lag_ms / 1e3,
            lag_spread_s=given.mxt_lag_spread_ms / 1e3,
            holds_early=given.mxt_holds_early,
        )
        controller = _controller(context, device)
        program = Mxt(controller, context.beam_bench, options, context.keeper.sync)
        controller.install(program)
        controller.real_time = program
        controller.parameters.preset("MXTTOUT", [str(options.timeout_cycles)])
        return lambda: MxtSession(program, note)

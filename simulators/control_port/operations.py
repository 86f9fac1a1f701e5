"""What each request of the control port does to the bench, and the conversation with its clients."""

from dataclasses import asdict, dataclass
from functools import singledispatch
from itertools import chain
from typing import Any

from pydantic import ValidationError

from catseye.simulators.context import EmulationContext
from catseye.simulators.control_port import messages
from catseye.simulators.control_port.messages import (
    Answer,
    Request,
    decode_request,
    encode_answer,
    encode_refusal,
)
from catseye.simulators.errors import EmulatorError
from catseye.simulators.ports.lossy import Lossy
from catseye.simulators.ports.port import Port
from catseye.simulators.ports.session import Session
from catseye.simulators.world.air_probe import AirFault
from catseye.simulators.world.tracker import Tracker

_DONE = Answer()


@dataclass(frozen=True)
class Reach:
    """What the control port can reach.

    Attributes:
        context: the emulated bench.
        tracker: the emulated laser tracker.
        ports: the instruments' ports by the name of the device.
    """

    context: EmulationContext
    tracker: Tracker
    ports: dict[str, list[Port]]

    def ports_of(self, device: str) -> list[Port]:
        """Return the ports of a device.

        Raises:
            EmulatorError: there is no such device.
        """
        if device not in self.ports:
            raise EmulatorError(f"device: there is no {device!r}; there are {', '.join(self.ports)}")
        return self.ports[device]


@singledispatch
def carry_out(request: Request[Any], reach: Reach) -> Answer:
    """Carry out a request.

    Raises:
        EmulatorError: the bench cannot do it in its present state.
    """
    del reach
    raise TypeError(f"{type(request).__name__} has no operation")


@carry_out.register
def _identify(request: messages.Identify, reach: Reach) -> Answer:
    del request
    context = reach.context
    return messages.Identity(
        name="catseye bench EMULATOR", time_s=context.bench.time_s, speed=context.keeper.speed
    )


@carry_out.register
def _truth(request: messages.ReadTruth, reach: Reach) -> Answer:
    del request
    return messages.Truth(truth=dict(reach.context.truth))


@carry_out.register
def _state(request: messages.ReadState, reach: Reach) -> Answer:
    del request
    context, bench = reach.context, reach.context.bench
    true = bench.true_state()
    return messages.State(
        time_s=bench.time_s,
        joints=bench.joints,
        true_joints=true.joints,
        play=true.play,
        xy_mm=true.axis_mm,
        moving=bench.moving,
        servo=context.controller.servo_on,
        alarm=context.controller.alarm,
        beam=_beam(context),
        coils=context.coils,
        mount=_mount(context),
        in_place=bench.beam.in_place,
        laser_ready=bench.beam.laser_ready,
    )


def _beam(context: EmulationContext) -> messages.BeamState:
    bench, true = context.bench, context.bench.true_state()
    latches = {name: instrument.beam_lost for name, instrument in context.instruments.items()}
    return messages.BeamState(
        reflector=true.reflector,
        returns=true.reflector is not None,
        lost=latches.get("interferometer", bench.beam.lost),
        lost_of=latches,
        nearest=true.nearest,
        miss_mm=true.miss_mm,
        largest_miss_mm=bench.beam.largest_miss_mm,
        length_mm=true.length_mm,
        direction_deg=true.beam_deg,
    )


def _mount(context: EmulationContext) -> messages.MountState:
    mount = context.bench.beam.mount
    return messages.MountState(
        offset_mm=mount.offset_mm,
        pitch_mrad=1e3 * mount.pitch_rad,
        height_j3_mm=mount.height_mm,
        turns={name: screw.turns for name, screw in mount.screws.items()},
    )


@carry_out.register
def _track(request: messages.Track, reach: Reach) -> Answer:
    del request
    x_mm, y_mm = reach.tracker.measure(reach.context.bench.true_state().axis_mm)
    return messages.TrackedPlace(x_mm=x_mm, y_mm=y_mm, u_mm=reach.tracker.u_mm)


@carry_out.register
def _log(request: messages.ReadLog, reach: Reach) -> Answer:
    reach.ports_of(request.device)
    entries = reach.context.journal.entries(request.device)
    return messages.Log(entries=[messages.JournalEntry(**asdict(entry)) for entry in entries])


@carry_out.register
def _speed(request: messages.SetSpeed, reach: Reach) -> Answer:
    reach.context.keeper.speed = request.value
    return _DONE


@carry_out.register
def _turn_screw(request: messages.TurnScrew, reach: Reach) -> Answer:
    reach.context.bench.beam.turn_screw(request.screw, request.turns)
    return _DONE


@carry_out.register
def _place_reflector(request: messages.PlaceReflector, reach: Reach) -> Answer:
    reach.context.bench.beam.place_reflector(request.reflector)
    return messages.Nests(in_place=reach.context.bench.beam.in_place)


@carry_out.register
def _clear_beam(request: messages.ClearBeam, reach: Reach) -> Answer:
    del request
    reach.context.bench.beam.unblock()
    return _DONE


@carry_out.register
def _block_beam(request: messages.BlockBeam, reach: Reach) -> Answer:
    reach.context.bench.beam.block(request.duration_s)
    return _DONE


@carry_out.register
def _clear_faults(request: messages.ClearFaults, reach: Reach) -> Answer:
    del request
    context = reach.context
    context.bench.clear_faults()
    context.controller.clear_faults()
    context.probe.fault = AirFault()
    context.door.closed = True
    for port in chain.from_iterable(reach.ports.values()):
        port.muted = False
        port.lossy = None
        port.stalled_until_s = 0.0
    context.keeper.changed()
    return _DONE


@carry_out.register
def _alarm(request: messages.RaiseAlarm, reach: Reach) -> Answer:
    reach.context.controller.raise_alarm(request.number)
    return _DONE


@carry_out.register
def _emergency_stop(request: messages.EmergencyStop, reach: Reach) -> Answer:
    reach.context.controller.set_emergency_stop(on=request.on)
    return _DONE


@carry_out.register
def _teach_mode(request: messages.TeachMode, reach: Reach) -> Answer:
    reach.context.controller.set_teach_mode(on=request.on)
    return _DONE


@carry_out.register
def _servo_off(request: messages.ServoOff, reach: Reach) -> Answer:
    del request
    reach.context.controller.switch_servo_off()
    return _DONE


@carry_out.register
def _move_reflector(request: messages.MoveReflector, reach: Reach) -> Answer:
    reach.context.bench.beam.move_reflector(request.reflector, request.dx_mm, request.dy_mm)
    return _DONE


@carry_out.register
def _spoil_air(request: messages.SpoilAir, reach: Reach) -> Answer:
    errors = (request.temperature_k, request.pressure_hpa, request.humidity_percent)
    reach.context.probe.fault = AirFault(request.nan, *errors)
    return _DONE


@carry_out.register
def _door(request: messages.MoveDoor, reach: Reach) -> Answer:
    reach.context.door.closed = not request.open
    return _DONE


@carry_out.register
def _stall(request: messages.Stall, reach: Reach) -> Answer:
    for port in reach.ports_of(request.device):
        port.stalled_until_s = reach.context.bench.time_s + request.duration_s
    return _DONE


@carry_out.register
def _drop(request: messages.Drop, reach: Reach) -> Answer:
    for port in reach.ports_of(request.device):
        port.drop()
    return _DONE


@carry_out.register
def _mute(request: messages.Mute, reach: Reach) -> Answer:
    for port in reach.ports_of(request.device):
        port.muted = True
    return _DONE


@carry_out.register
def _spoil_answers(request: messages.SpoilAnswers, reach: Reach) -> Answer:
    for number, port in enumerate(reach.ports_of(request.device)):
        port.lossy = Lossy(request.share, request.seed + number)
    return _DONE


@carry_out.register
def _overspeed(request: messages.Overspeed, reach: Reach) -> Answer:
    del request
    reach.context.bench.beam.outrun_counters()
    return _DONE


@carry_out.register
def _vibrate(request: messages.Vibrate, reach: Reach) -> Answer:
    reach.context.bench.shake(1e-3 * request.amplitude_um, request.duration_s)
    return _DONE


@carry_out.register
def _laser(request: messages.LoseLaser, reach: Reach) -> Answer:
    reach.context.bench.beam.set_laser(ready=request.ready)
    return _DONE


@carry_out.register
def _weaken(request: messages.Weaken, reach: Reach) -> Answer:
    reach.context.bench.beam.weaken(request.factor)
    return _DONE


@carry_out.register
def _slip(request: messages.Slip, reach: Reach) -> Answer:
    reach.context.bench.slip(request.joint, request.deg)
    return _DONE


LONGEST_BYTES = 65_536


class ControlSession(Session):
    """Conversation with one client of the control port."""

    def __init__(self, reach: Reach) -> None:
        self._reach = reach
        self._bytes = bytearray()

    def feed(self, data: bytes) -> None:
        """Take bytes, cut anywhere."""
        self._bytes += data

    def answer(self) -> bytes | None:
        """Carry out the next line."""
        line, newline, rest = self._bytes.partition(b"\n")
        if not newline and len(self._bytes) <= LONGEST_BYTES:
            return None
        self._bytes = rest
        try:
            return encode_answer(carry_out(decode_request(bytes(line)), self._reach))
        except ValidationError as error:
            first = error.errors()[0]
            key = ".".join(str(part) for part in first["loc"])
            return encode_refusal(f"{key}: {first['msg']}")
        except EmulatorError as error:
            return encode_refusal(str(error))

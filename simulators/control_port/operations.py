"""What each request of the control port does to the bench, and the conversation with its clients."""

import math
from dataclasses import asdict, dataclass
from itertools import chain
from typing import Any

from pydantic import ValidationError

from catseye.simulators.abb.controller import AbbController
from catseye.simulators.abb.failing import Failing
from catseye.simulators.context import EmulationContext
from catseye.simulators.control_port import faults, gauge_messages, messages
from catseye.simulators.control_port.exchange import Answer, Request, encode_answer, encode_refusal
from catseye.simulators.control_port.messages import decode_request
from catseye.simulators.control_port.survey_messages import LeadTracker, SurveyRequest
from catseye.simulators.control_port.survey_operations import spoil_the_room, work_in_the_room
from catseye.simulators.emulator import Role, load_emulator
from catseye.simulators.errors import EmulatorError
from catseye.simulators.ports.lossy import Lossy
from catseye.simulators.ports.port import Port
from catseye.simulators.ports.session import Session
from catseye.simulators.world.air_probe import AirFault
from catseye.simulators.world.axis_gauge import AxisGauge
from catseye.simulators.world.beam import Beam
from catseye.simulators.world.bench import Bench
from catseye.simulators.world.optics import NOBODY
from catseye.simulators.world.serial.bench import SerialBench
from catseye.simulators.world.serial.tracker import LaserTracker
from catseye.simulators.world.tracker import Tracker

LONGEST_BYTES = 65_536


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

    def ports_in_role(self, role: Role) -> list[Port]:
        """Return the ports of all devices in a role."""
        return [port for port in chain.from_iterable(self.ports.values()) if _role(port) == role]


def carry_out(request: Request[Any], reach: Reach) -> Answer:
    """Carry out a request.

    Raises:
        EmulatorError: the bench cannot do it in its present state.
    """
    context = reach.context
    match request:
        case messages.Identify():
            name, time_s = "catseye bench EMULATOR", context.bench.time_s
            return messages.Identity(
                name=name,
                time_s=time_s,
                speed=context.keeper.speed,
                behind_s=context.keeper.behind_s,
                started=context.started,
                truth=context.truth_digest,
            )
        case messages.ReadTruth():
            return messages.Truth(truth=dict(context.truth))
        case messages.ReadState():
            return _state(context)
        case messages.Track():
            x_mm, y_mm = reach.tracker.measure(context.bench.tracked_mm)
            return messages.TrackedPlace(x_mm=x_mm, y_mm=y_mm, u_mm=reach.tracker.u_mm)
        case messages.ReadArm():
            return _arm(context)
        case messages.ReadLog():
            reach.ports_of(request.device)
            entries = context.journal.entries(request.device)
            return messages.Log(entries=[messages.JournalEntry(**asdict(entry)) for entry in entries])
        case messages.SetSpeed():
            context.keeper.speed = request.value
        case messages.PressKey():
            _require_power("robot", reach)
            context.controller.press(request.key)
        case messages.TurnScrew():
            context.bench.beam.turn_screw(request.screw, request.turns)
        case messages.ClearBeam():
            context.bench.clear_beam()
        case LeadTracker():
            _require_power("tracker", reach)
            _lead(request, context.laser_tracker)
        case faults.Fault():
            _happen(request, reach)
        case messages.MountAngularOptics() | messages.MountLinearOptics() | messages.ReadOptics():
            return _work_on_the_optics(request, context.serial_bench)
        case _ if isinstance(request, SurveyRequest):
            return work_in_the_room(request, context.serial_bench)
        case _ if isinstance(request, gauge_messages.GaugeRequest):
            return _work_at_the_axis(request, context.beam_bench.gauge)
        case _:
            return _work_on_the_beam(request, context.beam_bench.beam)
    return Answer()


def _lead(request: LeadTracker, tracker: LaserTracker) -> None:
    if not tracker.lead(request.target):
        raise EmulatorError(f"the tracker finds no retroreflector where hands have led it: {request.target}")


def _work_on_the_optics(request: Request[Any], bench: SerialBench) -> Answer:
    match request:
        case messages.MountAngularOptics():
            joint = bench.joint_named(request.joint)
            bench.beam.mount_angular(joint, request.lever_mm, request.offset_mm)
        case messages.MountLinearOptics():
            x, y, z = (1.0 if axis == request.axis else 0.0 for axis in "XYZ")
            bench.beam.mount_linear((x, y, z))
    mounting, sight = bench.beam.mounting, bench.beam.observe()
    return messages.OpticsState(
        kind=None if mounting is None else mounting.kind,
        joint=None if mounting is None else bench.joint_names[mounting.frame - 1],
        returns=bool(sight.index[0] != NOBODY),
        miss=float(sight.miss_mm[0]),
        spacing_mm=bench.beam.spacing_mm,
        tilts_mrad=bench.beam.tilts_mrad,
        turns={name: screw.turns for name, screw in bench.beam.screws.items()},
    )


def _work_on_the_beam(request: Request[Any], beam: Beam) -> Answer:
    match request:
        case messages.MountInterferometer():
            beam.remount(request.turned_deg)
        case messages.PlaceReflector():
            beam.place_reflector(request.reflector)
            return messages.Nests(in_place=beam.in_place)
        case _:
            raise TypeError(f"{type(request).__name__} has no operation")
    return Answer()


def _work_at_the_axis(request: gauge_messages.GaugeRequest, gauge: AxisGauge) -> Answer:
    match request:
        case gauge_messages.MountArtefact():
            gauge.mount(request.joint, turned=request.turned)
        case gauge_messages.TapArtefact():
            gauge.tap(request.by_um)
        case gauge_messages.ReadIndicator():
            return gauge_messages.IndicatorReading(reading_um=gauge.reading_um(request.direction))
        case gauge_messages.TakeIndicatorOff():
            gauge.take_off()
    return Answer()


def _happen(fault: faults.Fault, reach: Reach) -> None:
    context, bench, controller = reach.context, reach.context.bench, reach.context.controller
    match fault:
        case faults.ClearFaults():
            _clear_faults(reach)
        case faults.RaiseAlarm():
            controller.raise_alarm(fault.number)
        case faults.EmergencyStop():
            controller.set_emergency_stop(on=fault.on)
        case faults.TeachMode():
            controller.set_teach_mode(on=fault.on)
        case faults.ServoOff():
            controller.switch_servo_off()
        case faults.BlockBeam():
            bench.block_beam(fault.duration_s)
        case faults.Overspeed():
            bench.beam.outrun_counters()
        case faults.LoseLaser():
            bench.beam.set_laser(ready=fault.ready)
        case faults.Weaken():
            bench.beam.weaken(fault.factor)
        case faults.SpoilAir():
            errors = (fault.temperature_k, fault.pressure_hpa, fault.humidity_percent)
            context.air.fault = AirFault(fault.nan, *errors)
        case faults.MoveDoor():
            context.door.closed = not fault.open
        case faults.Stall():
            for port in reach.ports_of(fault.device):
                port.stalled_until_s = bench.time_s + fault.duration_s
        case faults.Drop():
            for port in reach.ports_of(fault.device):
                port.drop()
        case faults.CutPower():
            _cut_power(fault, reach)
        case faults.Mute():
            for port in reach.ports_of(fault.device):
                port.muted = True
        case faults.SpoilAnswers():
            for number, port in enumerate(reach.ports_of(fault.device)):
                port.lossy = Lossy(fault.share, fault.seed + number)
        case faults.FailRequests():
            if not isinstance(controller, AbbController):
                raise EmulatorError("the robot of this bench has no web server: it is no ABB")
            controller.failing = Failing(fault.pattern, fault.carried_out, fault.count)
        case _ if isinstance(fault, faults.RoomFault):
            spoil_the_room(fault, context.serial_bench)
        case _:
            _push_the_arm(fault, context.beam_bench)


def _cut_power(fault: faults.CutPower, reach: Reach) -> None:
    context, ports = reach.context, reach.ports_of(fault.device)
    roles = {_role(port) for port in ports}
    if "robot" in roles:
        # Behind every endpoint of a robot there is the one controller.
        ports = reach.ports_in_role("robot")
        context.controller.lose_power()
    if "tracker" in roles:
        context.laser_tracker.lose_power()
    if fault.device in context.instruments:
        context.instruments[fault.device].restart()
    context.coils.pop(fault.device, None)
    for port in ports:
        context.power_back_s[port.device] = context.bench.time_s + fault.duration_s
        port.cut_power(fault.duration_s)


def _role(port: Port) -> Role:
    return load_emulator(port.protocol).role


def _require_power(role: Role, reach: Reach) -> None:
    for port in reach.ports_in_role(role):
        if port.is_off:
            raise EmulatorError(f"{port.device} has no power")


def _push_the_arm(fault: faults.Fault, bench: Bench) -> None:
    match fault:
        case faults.MoveReflector():
            bench.beam.move_reflector(fault.reflector, fault.dx_mm, fault.dy_mm)
        case faults.Vibrate():
            bench.shake(1e-3 * fault.amplitude_um, fault.duration_s)
        case faults.Slip():
            bench.slip(fault.joint, fault.deg)
        case _:
            raise TypeError(f"{type(fault).__name__} has no operation")


def _clear_faults(reach: Reach) -> None:
    context = reach.context
    context.bench.clear_faults()
    context.controller.clear_faults()
    context.air.fault = AirFault()
    context.door.closed = True
    for port in chain.from_iterable(reach.ports.values()):
        port.muted = False
        port.lossy = None
        port.stalled_until_s = port.off_until_s = 0.0
    now_s = context.bench.time_s
    for name, back_s in context.power_back_s.items():
        context.power_back_s[name] = min(back_s, now_s)
    context.keeper.changed()


def _arm(context: EmulationContext) -> Answer:
    bench = context.bench
    return messages.ArmState(
        time_s=bench.time_s,
        joints=bench.joints,
        true_joints=bench.true_joints,
        moving=bench.moving,
        servo=context.controller.servo_on,
        alarm=context.controller.alarm,
        air=_air(context),
        coils=context.coils,
    )


def _state(context: EmulationContext) -> Answer:
    bench = context.beam_bench
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
        air=_air(context),
        beam=_beam(context),
        coils=context.coils,
        mount=_mount(context),
        in_place=bench.beam.in_place,
        laser_ready=bench.beam.laser_ready,
    )


def _air(context: EmulationContext) -> messages.Air:
    return messages.Air(**asdict(context.bench.air()))


def _beam(context: EmulationContext) -> messages.BeamState:
    bench = context.beam_bench
    true = bench.true_state()
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
    mount = context.beam_bench.beam.mount
    return messages.MountState(
        turned_deg=math.degrees(mount.turn_rad),
        ahead_mm=mount.ahead_mm,
        offset_mm=mount.offset_mm,
        pitch_mrad=1e3 * mount.pitch_rad,
        height_j3_mm=mount.height_mm,
        turns={name: screw.turns for name, screw in mount.screws.items()},
    )


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

"""Control port: tells the truth and sets faults, outside the instruments' protocols. One JSON object a line.

Requests have `op` and its arguments; answers are `{"ok": true, …}` or `{"ok": false, "error": "…"}`.

`identify` · `truth` (the true arm in the result format) · `state` · `tracker` (the J4 axis as a laser tracker sees
it) · `log` {device} · `speed` {value} · what hands do: `turn_screw` {screw: "stage" or "level", turns: clockwise
positive} · `place_reflector` {reflector: its nest, the others are empty then; "all" fills them all} · `clear_beam` ·
`fault` {name, …}, with the names

`block_beam` {duration_s, null for ever} · `clear_faults` · `alarm` {number} · `emergency_stop` {on} ·
`teach_mode` {on} · `servo_off` · `move_reflector` {reflector, dx_mm, dy_mm} · `air` {nan, temperature_k,
pressure_hpa, humidity_percent} · `door` {open} · `stall` {device, duration_s} · `drop` {device} · `mute` {device} ·
`lossy` {device, share of its answers that are lost, doubled or garbled, seed} ·
`overspeed` · `vibration` {amplitude_um, duration_s} · `laser` {ready} · `weaken` {factor} · `slip` {joint, deg}.
Durations are bench time. `clear_faults` ends what goes on: screws, reflectors and a lost count stay as they are.
"""

import json
from dataclasses import asdict, dataclass
from itertools import chain
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from catseye.simulators.context import EmulationContext
from catseye.simulators.errors import EmulatorError
from catseye.simulators.ports.lossy import Lossy
from catseye.simulators.ports.port import Port
from catseye.simulators.ports.session import Answer, Session
from catseye.simulators.world.air_probe import AirFault
from catseye.simulators.world.tracker import Tracker

LONGEST_BYTES = 65_536

Said = dict[str, object]


@dataclass(frozen=True)
class Desk:
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


class _Request(BaseModel):
    model_config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False)

    def carry_out(self, desk: Desk) -> Said:
        raise NotImplementedError


class _Identify(_Request):
    def carry_out(self, desk: Desk) -> Said:
        return {
            "name": "catseye bench EMULATOR",
            "time_s": desk.context.bench.time_s,
            "speed": desk.context.keeper.speed,
        }


class _Truth(_Request):
    def carry_out(self, desk: Desk) -> Said:
        return {"truth": desk.context.truth}


class _State(_Request):
    def carry_out(self, desk: Desk) -> Said:
        bench = desk.context.bench
        insight = bench.insight()
        latches = {name: instrument.beam_lost for name, instrument in desk.context.instruments.items()}
        beam = {
            "reflector": insight.reflector,
            "returns": insight.reflector is not None,
            "lost": latches.get("interferometer", bench.beam_lost),
            "lost_of": latches,
            "nearest": insight.nearest,
            "miss_mm": insight.miss_mm,
            "largest_miss_mm": bench.largest_miss_mm,
            "length_mm": insight.length_mm,
            "direction_deg": insight.beam_deg,
        }
        return {
            "time_s": bench.time_s,
            "joints": bench.joints,
            "true_joints": insight.joints,
            "play": insight.play,
            "xy_mm": insight.axis_mm,
            "moving": bench.moving,
            "servo": desk.context.controller.servo_on,
            "alarm": desk.context.controller.alarm,
            "beam": beam,
            "coils": desk.context.coils,
            "mount": {
                "offset_mm": bench.mount.offset_mm,
                "pitch_mrad": 1e3 * bench.mount.pitch_rad,
                "height_j3_mm": bench.mount.height_mm,
                "turns": {name: screw.turns for name, screw in bench.mount.screws.items()},
            },
            "in_place": bench.in_place,
            "laser_ready": bench.laser_ready,
        }


class _Tracker(_Request):
    def carry_out(self, desk: Desk) -> Said:
        x_mm, y_mm = desk.tracker.measure(desk.context.bench.insight().axis_mm)
        return {"x_mm": x_mm, "y_mm": y_mm, "u_mm": desk.tracker.u_mm}


class _Log(_Request):
    device: str

    def carry_out(self, desk: Desk) -> Said:
        desk.ports_of(self.device)
        return {"entries": [asdict(entry) for entry in desk.context.journal.entries(self.device)]}


class _Speed(_Request):
    value: float = Field(gt=0.0)

    def carry_out(self, desk: Desk) -> Said:
        desk.context.keeper.speed = self.value
        return {}


class _TurnScrew(_Request):
    screw: Literal["stage", "level"]
    # A screw has an end, and so has a hand's patience.
    turns: float = Field(ge=-20.0, le=20.0)

    def carry_out(self, desk: Desk) -> Said:
        desk.context.bench.turn_screw(self.screw, self.turns)
        return {}


class _PlaceReflector(_Request):
    reflector: str

    def carry_out(self, desk: Desk) -> Said:
        desk.context.bench.place_reflector(self.reflector)
        return {"in_place": desk.context.bench.in_place}


class _ClearBeam(_Request):
    def carry_out(self, desk: Desk) -> Said:
        desk.context.bench.unblock_beam()
        return {}


class _Overspeed(_Request):
    def carry_out(self, desk: Desk) -> Said:
        desk.context.bench.outrun_counters()
        return {}


class _Vibration(_Request):
    amplitude_um: float = Field(gt=0.0, le=5000.0)
    duration_s: float = Field(gt=0.0, le=3600.0)

    def carry_out(self, desk: Desk) -> Said:
        desk.context.bench.shake(1e-3 * self.amplitude_um, self.duration_s)
        return {}


class _Laser(_Request):
    ready: bool = False

    def carry_out(self, desk: Desk) -> Said:
        desk.context.bench.set_laser(ready=self.ready)
        return {}


class _Weaken(_Request):
    factor: float = Field(gt=0.0, le=1.0)

    def carry_out(self, desk: Desk) -> Said:
        desk.context.bench.weaken(self.factor)
        return {}


class _Slip(_Request):
    joint: Literal[1, 2, 4]
    deg: float = Field(ge=-30.0, le=30.0)

    def carry_out(self, desk: Desk) -> Said:
        desk.context.bench.slip(self.joint, self.deg)
        return {}


class _BlockBeam(_Request):
    duration_s: float | None = Field(default=None, gt=0.0)

    def carry_out(self, desk: Desk) -> Said:
        desk.context.bench.block_beam(self.duration_s)
        return {}


class _ClearFaults(_Request):
    def carry_out(self, desk: Desk) -> Said:
        desk.context.bench.clear_faults()
        desk.context.controller.clear_faults()
        desk.context.probe.fault = AirFault()
        desk.context.door.closed = True
        for port in chain.from_iterable(desk.ports.values()):
            port.muted = False
            port.lossy = None
            port.stalled_until_s = 0.0
        desk.context.keeper.changed()
        return {}


class _Alarm(_Request):
    number: int = Field(ge=1, le=9999)

    def carry_out(self, desk: Desk) -> Said:
        desk.context.controller.raise_alarm(self.number)
        return {}


class _EmergencyStop(_Request):
    on: bool = True

    def carry_out(self, desk: Desk) -> Said:
        desk.context.controller.set_emergency_stop(on=self.on)
        return {}


class _TeachMode(_Request):
    on: bool = True

    def carry_out(self, desk: Desk) -> Said:
        desk.context.controller.set_teach_mode(on=self.on)
        return {}


class _ServoOff(_Request):
    def carry_out(self, desk: Desk) -> Said:
        desk.context.controller.switch_servo_off()
        return {}


class _MoveReflector(_Request):
    reflector: str
    dx_mm: float = 0.0
    dy_mm: float = 0.0

    def carry_out(self, desk: Desk) -> Said:
        desk.context.bench.move_reflector(self.reflector, self.dx_mm, self.dy_mm)
        return {}


class _Air(_Request):
    nan: bool = False
    temperature_k: float = 0.0
    pressure_hpa: float = 0.0
    humidity_percent: float = 0.0

    def carry_out(self, desk: Desk) -> Said:
        errors = (self.temperature_k, self.pressure_hpa, self.humidity_percent)
        desk.context.probe.fault = AirFault(self.nan, *errors)
        return {}


class _Door(_Request):
    open: bool = True

    def carry_out(self, desk: Desk) -> Said:
        desk.context.door.closed = not self.open
        return {}


class _Stall(_Request):
    device: str
    duration_s: float = Field(gt=0.0)

    def carry_out(self, desk: Desk) -> Said:
        for port in desk.ports_of(self.device):
            port.stalled_until_s = desk.context.bench.time_s + self.duration_s
        return {}


class _Drop(_Request):
    device: str

    def carry_out(self, desk: Desk) -> Said:
        for port in desk.ports_of(self.device):
            port.drop()
        return {}


class _Mute(_Request):
    device: str

    def carry_out(self, desk: Desk) -> Said:
        for port in desk.ports_of(self.device):
            port.muted = True
        return {}


class _Lossy(_Request):
    device: str
    share: float = Field(ge=0.0, le=1.0)
    seed: int = Field(default=0, ge=0)

    def carry_out(self, desk: Desk) -> Said:
        for number, port in enumerate(desk.ports_of(self.device)):
            port.lossy = Lossy(self.share, self.seed + number)
        return {}


_OPERATIONS: dict[str, type[_Request]] = {
    "identify": _Identify,
    "truth": _Truth,
    "state": _State,
    "tracker": _Tracker,
    "log": _Log,
    "speed": _Speed,
    "turn_screw": _TurnScrew,
    "place_reflector": _PlaceReflector,
    "clear_beam": _ClearBeam,
}
_FAULTS: dict[str, type[_Request]] = {
    "block_beam": _BlockBeam,
    "clear_faults": _ClearFaults,
    "alarm": _Alarm,
    "emergency_stop": _EmergencyStop,
    "teach_mode": _TeachMode,
    "servo_off": _ServoOff,
    "move_reflector": _MoveReflector,
    "air": _Air,
    "door": _Door,
    "stall": _Stall,
    "drop": _Drop,
    "mute": _Mute,
    "lossy": _Lossy,
    "overspeed": _Overspeed,
    "vibration": _Vibration,
    "laser": _Laser,
    "weaken": _Weaken,
    "slip": _Slip,
}


class ControlSession(Session):
    """Conversation with one client of the control port.

    Args:
        desk: what it can reach.
    """

    def __init__(self, desk: Desk) -> None:
        self._desk = desk
        self._bytes = bytearray()

    def feed(self, data: bytes) -> None:
        """Take bytes, cut anywhere."""
        self._bytes += data

    def answer(self) -> Answer | None:
        """Carry out the next line."""
        line, newline, rest = self._bytes.partition(b"\n")
        if not newline and len(self._bytes) <= LONGEST_BYTES:
            return None
        self._bytes = rest
        said = self._said(bytes(line))
        return json.dumps(said).encode() + b"\n"

    def _said(self, line: bytes) -> Said:
        try:
            return {"ok": True, **_parse(line).carry_out(self._desk)}
        except ValidationError as error:
            first = error.errors()[0]
            key = ".".join(str(part) for part in first["loc"])
            return {"ok": False, "error": f"{key}: {first['msg']}"}
        except EmulatorError as error:
            return {"ok": False, "error": str(error)}


def _parse(line: bytes) -> _Request:
    try:
        document = json.loads(line)
    except (ValueError, RecursionError) as error:
        raise EmulatorError("a request is one JSON object on one line") from error
    if not isinstance(document, dict):
        raise EmulatorError("a request is one JSON object on one line")
    operation = document.pop("op", None)
    if operation == "fault":
        return _known(_FAULTS, "fault", document.pop("name", None)).model_validate(document)
    return _known({**_OPERATIONS, "fault": _Request}, "op", operation).model_validate(document)


def _known(table: dict[str, type[_Request]], what: str, name: object) -> type[_Request]:
    if not isinstance(name, str) or name not in table:
        raise EmulatorError(f"there is no {what} {name!r}; there are {', '.join(table)}")
    return table[name]

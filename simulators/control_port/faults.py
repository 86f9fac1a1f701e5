"""What can go wrong on the bench, by requests of the control port.

A fault is a request with `"op": "fault"`, its `name` and its arguments. Durations are bench time.
"""

import re
from typing import Any, ClassVar, Literal

from pydantic import Field, field_validator

from catseye.simulators.control_port.exchange import Answer, Request, known


class Fault(Request[Answer]):
    """Something goes wrong."""

    op = "fault"
    name: ClassVar[str]

    def arguments(self) -> dict[str, Any]:
        """Return what the line holds."""
        return {"op": self.op, "name": self.name, **self.model_dump()}


class BlockBeam(Fault):
    """Something stands in the beam; None: for ever."""

    name = "block_beam"
    duration_s: float | None = Field(default=None, gt=0.0)


class ClearFaults(Fault):
    """End what goes on: screws, reflectors and a lost count stay as they are."""

    name = "clear_faults"


class RaiseAlarm(Fault):
    """An alarm of the controller occurs."""

    name = "alarm"
    number: int = Field(ge=1, le=9999)


class EmergencyStop(Fault):
    """Somebody presses the emergency stop, or releases it."""

    name = "emergency_stop"
    on: bool = True


class TeachMode(Fault):
    """Somebody turns the controller's key."""

    name = "teach_mode"
    on: bool = True


class ServoOff(Fault):
    """The drives lose their power."""

    name = "servo_off"


class MoveReflector(Fault):
    """Somebody pushes a reflector."""

    name = "move_reflector"
    reflector: str
    dx_mm: float = 0.0
    dy_mm: float = 0.0


class SpoilAir(Fault):
    """The air sensors are wrong by so much, or measure nothing."""

    name = "air"
    nan: bool = False
    temperature_k: float = 0.0
    pressure_hpa: float = 0.0
    humidity_percent: float = 0.0


class MoveDoor(Fault):
    """Somebody opens or closes the door."""

    name = "door"
    open: bool = True


class Stall(Fault):
    """A device hangs for a time, then answers late."""

    name = "stall"
    device: str
    duration_s: float = Field(gt=0.0)


class Drop(Fault):
    """A device closes its links; new ones are welcome."""

    name = "drop"
    device: str


class CutPower(Fault):
    """A device has no power for a time; what it does not keep without power is lost."""

    name = "cut_power"
    device: str
    duration_s: float = Field(gt=0.0)


class Mute(Fault):
    """A device works on and says nothing."""

    name = "mute"
    device: str


class SpoilAnswers(Fault):
    """A share of a device's answers is lost, doubled or garbled."""

    name = "lossy"
    device: str
    share: float = Field(ge=0.0, le=1.0)
    seed: int = Field(default=0, ge=0)


class FailRequests(Fault):
    """The web server of an ABB answers the next requests with 503; `carried_out`: they take effect all the same."""

    name = "web_error"
    pattern: str = Field(default="", max_length=200)
    carried_out: bool = False
    count: int = Field(default=1, ge=1, le=1_000_000)

    @field_validator("pattern")
    @classmethod
    def _compiles(cls, pattern: str) -> str:
        try:
            re.compile(pattern)
        except re.error as exc:
            raise ValueError(f"{pattern!r} is no regular expression: {exc}") from None
        return pattern


class Overspeed(Fault):
    """All counters lose count as after too fast a motion."""

    name = "overspeed"


class Vibrate(Fault):
    """Something keeps the arm ringing."""

    name = "vibration"
    amplitude_um: float = Field(gt=0.0, le=5000.0)
    duration_s: float = Field(gt=0.0, le=3600.0)


class LoseLaser(Fault):
    """The laser loses its lock, or finds it again."""

    name = "laser"
    ready: bool = False


class Weaken(Fault):
    """Dirt leaves this part of the signal."""

    name = "weaken"
    factor: float = Field(gt=0.0, le=1.0)


class Slip(Fault):
    """The next move ends so far off, as after a collision."""

    name = "slip"
    joint: Literal[1, 2, 4]
    deg: float = Field(ge=-30.0, le=30.0)


class DropTarget(Fault):
    """A retroreflector falls out of its nest."""

    name = "drop_target"
    target: str


class LoosenTarget(Fault):
    """A nest sits loosely: it shifts with each motion, each coordinate by so much in the mean."""

    name = "loosen_target"
    target: str
    mm: float = Field(default=0.2, gt=0.0, le=20.0)


class Bump(Fault):
    """Somebody bumps into an instrument in the room of a serial arm."""

    name = "bump"
    instrument: Literal["tracker", "cmm"] = "tracker"
    mm: float = Field(default=0.5, ge=0.0, le=500.0)
    deg: float = Field(default=0.02, ge=0.0, le=45.0)


class ReadBack(Fault):
    """The controller reads joints back that are off by so much: half of it always, half of it anew at each motion."""

    name = "readback"
    deg: float = Field(ge=0.0, le=5.0)


RoomFault = DropTarget | LoosenTarget | Bump | ReadBack
"""In the room of a serial arm."""

_FAULTS: dict[str, type[Fault]] = {kind.name: kind for kind in Fault.__subclasses__()}


def fault_named(name: object, arguments: dict[str, object]) -> Fault:
    """Return a fault by its name.

    Raises:
        EmulatorError: there is no such fault.
        ValidationError: an argument is wrong.
    """
    return known(_FAULTS, "fault", name).model_validate(arguments)

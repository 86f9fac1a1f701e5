"""The messages between an engine and its clients: JSON, one object a line, version 1."""

import json
from collections.abc import Mapping
from typing import Annotated, Any, Final, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from catseye.app.service.errors import BadMessageError
from catseye.procedures.kit.context import Json

VERSION: Final = 1

MAX_LINE_BYTES: Final = 64 * 1024
"""A longer line is no message; whoever sends one is disconnected."""

Message = dict[str, Json]
Text = Annotated[str, Field(max_length=1000)]
Name = Annotated[str, Field(min_length=1, max_length=80, pattern=r"^[^\p{C}\p{Zl}\p{Zp}]+$")]


class Request(BaseModel):
    """What every request carries.

    Attributes:
        v: version of the protocol.
        id: chosen by the client; the answer names it as `re`.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    v: Literal[1]
    id: int | Annotated[str, Field(max_length=80)]


class Hello(Request):
    """Introduce oneself; events come from now on. The answer carries the snapshot.

    Attributes:
        client: name of the program.
        who: the person, as the run stores it.
    """

    op: Literal["hello"]
    client: Name
    who: Name


class Control(Request):
    """Take control, or give it back.

    Attributes:
        take: False gives it back.
        force: take it from another client.
    """

    op: Literal["control"]
    take: bool = True
    force: bool = False


class HandOver(Request):
    """Give control to another client.

    Attributes:
        to: its name, as the snapshot lists it.
    """

    op: Literal["hand-over"]
    to: Name


class Plain(Request):
    """A request that needs no more words."""

    op: Literal["release", "hold", "unhold", "stop", "abort", "clear", "ping", "shutdown"]


class Reply(Request):
    """The answer to a prompt.

    Attributes:
        prompt: its id.
        text: the answer.
    """

    op: Literal["answer"]
    prompt: Text
    text: Text


class Override(Request):
    """Lower the speed override before the next motion.

    Attributes:
        percent: of the programmed speed; controllers round down to a whole one.
    """

    op: Literal["override"]
    percent: float = Field(ge=1.0, le=100.0, allow_inf_nan=False)


class Start(Request):
    """Run a procedure on an idle engine.

    Attributes:
        procedure: its name.
        cell: cell file; the engine's own when left out.
        params: by name, or as `name=value` texts of the command line.
        search: "auto", "none" or a search run.
        arm: the cell's name, typed to let real hardware move.
        speed: bench seconds in one real second; emulators only.
        answers: file of prompt id = answer.
        walk: walk its motions through instead; nothing is measured.
        waive_walk: why a real arm may be driven where it was not walked.
        keep_drives: leave the drives on at the end for good; otherwise an engine switches them off after some rest,
            and one that runs once at the end.
    """

    op: Literal["start"]
    procedure: Name
    cell: Text | None = None
    params: dict[str, Any] | list[Text] = Field(default_factory=dict)
    search: Text = "auto"
    arm: Text | None = None
    speed: float = Field(default=1.0, ge=0.001, le=1e6, allow_inf_nan=False)
    answers: Text | None = None
    walk: bool = False
    waive_walk: Text | None = None
    keep_drives: bool = False


class Resume(Request):
    """Go on with an interrupted run on an idle engine.

    Attributes:
        run: path, name, beginning of a name, or id.
        arm: the cell's name, typed to let real hardware move.
        answers: file of prompt id = answer.
        waive_walk: why a real arm may be driven where it was not walked.
        keep_drives: leave the drives on at the end for good; otherwise an engine switches them off after some rest,
            and one that runs once at the end.
    """

    op: Literal["resume"]
    run: Text
    arm: Text | None = None
    answers: Text | None = None
    waive_walk: Text | None = None
    keep_drives: bool = False


class Watch(Request):
    """Be told about the bench: devices, arm, beam, air; `traffic` instead: the raw bytes of every link.

    Attributes:
        on: False ends it.
    """

    op: Literal["watch", "traffic"]
    on: bool = True


class JogMode(Request):
    """Begin or end moving joints by hand; between runs only.

    Attributes:
        on: False ends it and stops the arm.
        percent: speed override meanwhile, at most what the cell allows.
        arm: the cell's name, typed to let real hardware move.
    """

    op: Literal["jog"]
    on: bool
    percent: float = Field(default=5.0, ge=1.0, le=100.0, allow_inf_nan=False)
    arm: Text | None = None


class JogStep(Request):
    """Move one joint by a step; the answer comes when the arm stands.

    Attributes:
        joint: what moves; "beam" turns J4 so that the beam moves sideways at a reflector.
        by: deg; mm at the reflector for the beam.
        aim: reflector that J4 keeps the beam on while J1 or J2 moves, and that the beam's mm are measured at.
    """

    op: Literal["jog-step"]
    joint: Literal["j1", "j2", "j4", "beam"]
    by: float = Field(ge=-90.0, le=90.0, allow_inf_nan=False)
    aim: Name | None = None


class JogHold(Request):
    """Keep one joint moving; repeated at least every 0.2 s, or the arm stops.

    Attributes:
        joint: what moves.
        direction: which way; 0 stops now.
    """

    op: Literal["jog-hold"]
    joint: Literal["j1", "j2", "j4"]
    direction: Literal[-1, 0, 1]


class WalkFeed(Request):
    """Keep a walk going; repeated at least every 0.3 s, or the arm is stopped. It is no enabling device.

    Attributes:
        on: False stops the arm now.
    """

    op: Literal["walk-feed"]
    on: bool = True


class Raw(Request):
    """Take one device's link from its driver to send bytes by hand, or give it back; between runs only.

    Attributes:
        device: its name in the cell file.
        on: False gives it back.
        arm: the cell's name, typed to let bytes pass to a real robot.
    """

    op: Literal["raw"]
    device: Name
    on: bool = True
    arm: Text | None = None


class Send(Request):
    """Send bytes on a link that was taken by `raw`.

    Attributes:
        device: its name in the cell file.
        hex: the bytes.
    """

    op: Literal["send"]
    device: Name
    hex: Annotated[str, Field(min_length=2, max_length=4096, pattern=r"^([0-9a-f]{2})+$")]


AnyRequest = (
    Hello
    | Control
    | HandOver
    | Plain
    | Reply
    | Override
    | Start
    | Resume
    | Watch
    | JogMode
    | JogStep
    | JogHold
    | WalkFeed
    | Raw
    | Send
)
_REQUESTS: TypeAdapter[AnyRequest] = TypeAdapter(Annotated[AnyRequest, Field(discriminator="op")])


def decode_request(line: bytes) -> AnyRequest:
    """Return the request of a line.

    Raises:
        BadMessageError: the line is none; the text says what is wrong.
    """
    message = decode_object(line)
    number = message.get("id")
    re = number if isinstance(number, (int, str)) and not isinstance(number, bool) else None
    _require_version(message, re)
    try:
        return _REQUESTS.validate_python(message)
    except ValidationError as error:
        raise BadMessageError(_faults(error), re) from error


def decode_message(line: bytes) -> Message:
    """Return an answer or event of an engine.

    Raises:
        BadMessageError: the line is none, or of another version.
    """
    message = decode_object(line)
    _require_version(message, None)
    return message


def decode_object(line: bytes) -> Message:
    """Return the JSON object of a line.

    Raises:
        BadMessageError: the line is none.
    """
    try:
        message = json.loads(line)
    except (ValueError, RecursionError) as error:
        raise BadMessageError(f"this line is no JSON: {error}") from error
    if not isinstance(message, dict):
        raise BadMessageError("a message is a JSON object on a line of its own")
    return message


def encode(message: Mapping[str, Json]) -> bytes:
    """Return a message as its line; everything beyond ASCII is escaped, so that any text can be sent."""
    return json.dumps(message).encode("ascii") + b"\n"


def _require_version(message: Message, re: int | str | None) -> None:
    version = message.get("v")
    if isinstance(version, bool) or version != VERSION:
        raise BadMessageError(
            f"the message is of version {json.dumps(version)} and this catseye speaks version {VERSION}: use the "
            "same catseye on both sides",
            re,
        )


def _faults(error: ValidationError) -> str:
    faults = []
    for fault in error.errors(include_url=False, include_input=False):
        # The first part of a place is the op that chose the model.
        place = ".".join(str(part) for part in fault["loc"][1:])
        faults.append(f"{place}: {fault['msg']}" if place else str(fault["msg"]))
    return "; ".join(faults)

"""What clients ask of an engine."""

from typing import Annotated, Any, Literal, Self, assert_never

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from catseye.app.protocol.message import (
    VERSION,
    JsonObject,
    MessageError,
    RequestId,
    decode_object,
    encode_object,
    faults_of,
    require_version,
)

Text = Annotated[str, Field(max_length=1000)]
Name = Annotated[str, Field(min_length=1, max_length=80, pattern=r"^[^\p{C}\p{Zl}\p{Zp}]+$")]


class Request(BaseModel):
    """What every request has in common."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class Hello(Request):
    """Introduce oneself; events come from now on. The answer carries the snapshot.

    Attributes:
        client: name of the program.
        who: the person, as the run stores it.
    """

    op: Literal["hello"] = "hello"
    client: Name
    who: Name


class Control(Request):
    """Take control, or give it back.

    Attributes:
        take: False gives it back.
        force: take it from another client.
    """

    op: Literal["control"] = "control"
    take: bool = True
    force: bool = False


class HandOver(Request):
    """Give control to another client.

    Attributes:
        to: its name, as the snapshot lists it.
    """

    op: Literal["hand-over"] = "hand-over"
    to: Name


class Plain(Request):
    """A request that needs no more words. `ladder` takes the next rung of the stop ladder."""

    op: Literal["release", "ladder", "hold", "unhold", "stop", "abort", "clear", "ping", "shutdown"]


class Reply(Request):
    """The answer to a prompt.

    Attributes:
        prompt: its id.
        text: the answer.
    """

    op: Literal["answer"] = "answer"
    prompt: Text
    text: Text


class Override(Request):
    """Lower the speed override before the next motion.

    Attributes:
        percent: of the programmed speed; controllers round down to a whole one.
    """

    op: Literal["override"] = "override"
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
        job: of a campaign that the run belongs to; empty for none.
    """

    op: Literal["start"] = "start"
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
    job: Text = ""


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

    op: Literal["resume"] = "resume"
    run: Text
    arm: Text | None = None
    answers: Text | None = None
    waive_walk: Text | None = None
    keep_drives: bool = False


class Watch(Request):
    """Receive the bench: devices, arm, beam, air; `traffic` instead: the raw bytes of every link.

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

    op: Literal["jog"] = "jog"
    on: bool
    percent: float = Field(default=5.0, ge=1.0, le=100.0, allow_inf_nan=False)
    arm: Text | None = None


class JogStep(Request):
    """Move one joint by a step; the answer comes when the arm stands.

    Attributes:
        joint: what moves, an axis or something that the arm turns, such as the beam, in lower case.
        by: deg; mm of a prismatic axis, or of the beam at what it is aimed at.
        aim: reflector that the beam is kept on while another axis moves, and that its mm are measured at.
    """

    op: Literal["jog-step"] = "jog-step"
    joint: Name
    by: float = Field(ge=-90.0, le=90.0, allow_inf_nan=False)
    aim: Name | None = None


class JogHold(Request):
    """Keep one joint moving; repeated at least every 0.2 s, or the arm stops.

    Attributes:
        joint: what moves, in lower case.
        direction: which way; 0 stops now.
    """

    op: Literal["jog-hold"] = "jog-hold"
    joint: Name
    direction: Literal[-1, 0, 1]


class WalkFeed(Request):
    """Keep a walk going; repeated at least every 0.3 s, or the arm is stopped. It is no enabling device.

    Attributes:
        on: False stops the arm now.
    """

    op: Literal["walk-feed"] = "walk-feed"
    on: bool = True


class Emulate(Request):
    """Have the engine emulate every device of its cell file, as long as it lives.

    Attributes:
        speed: bench seconds in one real second.
    """

    op: Literal["emulate"] = "emulate"
    speed: float = Field(default=1.0, ge=0.001, le=1e6, allow_inf_nan=False)


class ResetAlarm(Request):
    """Reset the controller's alarm that a person has read; between runs only. Another one is not reset.

    Attributes:
        number: of the alarm.
        text: of the alarm, as it was shown.
    """

    op: Literal["reset-alarm"] = "reset-alarm"
    number: int = Field(ge=1)
    text: Text


class RestoreOverride(Request):
    """Set the speed override again that stood before a jog; between runs, and where nobody has changed it since.

    Attributes:
        percent: that is set, as it was shown.
    """

    op: Literal["restore-override"] = "restore-override"
    percent: float = Field(ge=1.0, le=100.0, allow_inf_nan=False)


class Raw(Request):
    """Take one device's link from its driver to send bytes by hand, or give it back; between runs only.

    Attributes:
        device: its name in the cell file.
        on: False gives it back.
        arm: the cell's name, typed to let bytes pass to a real robot.
    """

    op: Literal["raw"] = "raw"
    device: Name
    on: bool = True
    arm: Text | None = None


class Send(Request):
    """Send bytes on a link that was taken by `raw`.

    Attributes:
        device: its name in the cell file.
        hex: the bytes.
    """

    op: Literal["send"] = "send"
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
    | Emulate
    | ResetAlarm
    | RestoreOverride
    | Raw
    | Send
)
_REQUESTS: TypeAdapter[AnyRequest] = TypeAdapter(Annotated[AnyRequest, Field(discriminator="op")])


def may_move(request: AnyRequest) -> bool:
    """Return whether the arm may move after a request, or bytes may reach it.

    Such a request waits for no engine that is silent: it would be done whenever that wakes up. What ends a jog, a
    raw link or a walk lets nothing move. After an answer the run goes on, whichever it is; what the bytes of `send`
    mean nobody knows.
    """
    match request:
        case Reply() | Start() | Resume() | JogStep() | Send():
            return True
        case Plain():
            return request.op == "unhold"
        case JogMode() | WalkFeed() | Raw():
            return request.on
        case JogHold():
            return request.direction != 0
        case (
            Hello()
            | Control()
            | HandOver()
            | Override()
            | Watch()
            | Emulate()
            | ResetAlarm()
            | RestoreOverride()
        ):
            return False
    assert_never(request)


class Numbered(BaseModel):
    """What stands around a request on its line.

    Attributes:
        v: version of the protocol.
        id: chosen by the client; the answer names it as `re`.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    v: Literal[1]
    id: int | Annotated[str, Field(max_length=80)]

    @classmethod
    def taken_from(cls, message: dict[str, Any]) -> Self:
        """Return it, and leave what belongs to the request."""
        return cls.model_validate({name: message.pop(name) for name in ("v", "id") if name in message})


def request_of(fields: dict[str, Any], re: RequestId | None = None) -> AnyRequest:
    """Return the request that fields describe, `op` among them.

    Raises:
        MessageError: they describe none; the text says what is wrong.
    """
    try:
        return _REQUESTS.validate_python(fields)
    except ValidationError as error:
        # The first part of a place is the op that chose the model.
        raise MessageError(faults_of(error, skip=1), re) from error


def decode_request(line: bytes) -> tuple[RequestId, AnyRequest]:
    """Return id and request of a line.

    Raises:
        MessageError: the line is none; the text says what is wrong.
    """
    message = decode_object(line)
    number = message.get("id")
    re = number if isinstance(number, (int, str)) and not isinstance(number, bool) else None
    require_version(message, re)
    try:
        numbered = Numbered.taken_from(message)
    except ValidationError as error:
        raise MessageError(faults_of(error), re) from error
    return numbered.id, request_of(message, numbered.id)


def encode_request(number: RequestId, request: AnyRequest) -> bytes:
    """Return a request as its line."""
    fields: JsonObject = request.model_dump(mode="json")
    return encode_object({"v": VERSION, "id": number, **fields})

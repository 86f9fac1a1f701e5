"""What answers to requests carry."""

from typing import Any, TypeVar

from pydantic import ValidationError

from catseye.app.protocol.bench import BenchStatus
from catseye.app.protocol.ladder import Rung
from catseye.app.protocol.message import (
    VERSION,
    JsonObject,
    Message,
    MessageError,
    RequestId,
    encode_object,
    faults_of,
)
from catseye.app.protocol.snapshot import Snapshot

Found = TypeVar("Found", bound="Answer")


class Answer(Message):
    """What the answer to a request carries: nothing, unless a subclass says so."""


class Welcome(Answer):
    """To `hello`."""

    snapshot: Snapshot


class Climbed(Answer):
    """To `ladder`: the rung that was taken."""

    rung: Rung


class Opened(Answer):
    """To `start` and `resume`, when the record is open.

    Attributes:
        run: its name.
        path: of its record.
    """

    run: str
    path: str


class OverrideLowered(Answer):
    """To `override`.

    Attributes:
        percent: that was asked for.
        until_the_next_motion: what the controller reads until then.
    """

    percent: float
    until_the_next_motion: float


class Watching(Answer):
    """To `watch`: the bench as it is now; None where no bench is known."""

    bench: BenchStatus | None


class Jogging(Answer):
    """To `jog`, when the arm may be moved.

    Attributes:
        override_percent: as read back.
        simulated: all devices are emulated.
    """

    override_percent: float
    simulated: bool


class Stepped(Answer):
    """To `jog-step`, when the arm stands: its joints, in the order of the axes."""

    joints: tuple[float, ...]


class Moving(Answer):
    """To the first `jog-hold`, when the joint has been set going."""

    moving: str


class LinkTaken(Answer):
    """To `raw`, when bytes may be sent."""

    endpoint: str


class Refusal(Message):
    """To whatever is not done.

    Attributes:
        error: why, and what to do.
        exit_code: that it leads to; None where the line was no request.
    """

    error: str
    exit_code: int | None = None


def encode_answer(re: RequestId | None, answer: Answer) -> bytes:
    """Return the line of an answer."""
    return encode_object({"v": VERSION, "re": re, "ok": True, **answer.json_object()})


def encode_refusal(re: RequestId | None, refusal: Refusal) -> bytes:
    """Return the line of a refusal."""
    return encode_object(refused(re, refusal))


def refused(re: RequestId | None, refusal: Refusal) -> JsonObject:
    """Return a refusal as JSON has it; its exit code only where it has one."""
    code: JsonObject = {} if refusal.exit_code is None else {"exit_code": refusal.exit_code}
    return {"v": VERSION, "re": re, "ok": False, "error": refusal.error, **code}


def answer_as(kind: type[Found], message: dict[str, Any]) -> Found:
    """Return what an answer carries.

    Raises:
        MessageError: it is no such answer.
    """
    fields = {name: value for name, value in message.items() if name not in {"v", "re", "ok"}}
    try:
        return kind.model_validate(fields)
    except ValidationError as error:
        raise MessageError(f"{kind.__name__}: {faults_of(error)}") from error

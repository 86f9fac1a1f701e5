"""What a command of catseye says to the program that started it, on a descriptor of its own: a line of JSON each.

stderr is for people and is never parsed. `channel.EVENTS_FD` names the descriptor; without it nothing is written.
"""

from typing import Annotated, Any, Literal

from pydantic import Field, TypeAdapter, ValidationError

from catseye.app.protocol.message import Message, MessageError, faults_of


class CommandProgress(Message):
    """How far the command is.

    Attributes:
        title: what is under way.
        share: done, 0…1.
        elapsed_s: so far, real s.
        left_s: real s; None where it is not known yet.
        text: what it does.
    """

    kind: Literal["progress"] = "progress"
    title: str
    share: float
    elapsed_s: float
    left_s: float | None
    text: str


class CommandWarning(Message):
    """A warning that people read on stderr too."""

    kind: Literal["warning"] = "warning"
    text: str


class CommandFailed(Message):
    """Why the command ended with another code than 0.

    Attributes:
        text: cause and remedy.
        exit_code: of the process.
    """

    kind: Literal["failed"] = "failed"
    text: str
    exit_code: int


CommandEvent = CommandProgress | CommandWarning | CommandFailed
_EVENTS: TypeAdapter[CommandEvent] = TypeAdapter(Annotated[CommandEvent, Field(discriminator="kind")])


class EngineReady(Message):
    """`catseye engine` listens."""

    event: Literal["engine-ready"] = "engine-ready"
    socket: str
    runs: str
    pid: int


class EngineOpened(Message):
    """The record of a run with `--detach` is open."""

    event: Literal["opened"] = "opened"
    run: str
    path: str


class EngineBegun(Message):
    """Its devices are ready."""

    event: Literal["ready"] = "ready"


class EngineFailed(Message):
    """It could not begin."""

    event: Literal["failed"] = "failed"
    error: str
    exit_code: int


class EngineEnded(Message):
    """It has ended; the error is empty where all went well."""

    event: Literal["ended"] = "ended"
    error: str
    exit_code: int


EngineLine = EngineReady | EngineOpened | EngineBegun | EngineFailed | EngineEnded
_LINES: TypeAdapter[EngineLine] = TypeAdapter(Annotated[EngineLine, Field(discriminator="event")])


def command_event_of(message: dict[str, Any]) -> CommandEvent:
    """Return what a command says.

    Raises:
        MessageError: it says something else.
    """
    try:
        return _EVENTS.validate_python(message)
    except ValidationError as error:
        raise MessageError(faults_of(error, skip=1)) from error


def engine_line_of(message: dict[str, Any]) -> EngineLine:
    """Return what an engine says on stdout.

    Raises:
        MessageError: it says something else.
    """
    try:
        return _LINES.validate_python(message)
    except ValidationError as error:
        raise MessageError(faults_of(error, skip=1)) from error

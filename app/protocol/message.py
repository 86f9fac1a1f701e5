"""Lines of the socket: JSON, one object a line, version 1."""

import json
from typing import Annotated, Any, Final, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, JsonValue, ValidationError

VERSION: Final = 1

MAX_LINE_BYTES: Final = 64 * 1024
"""A longer line is no request; whoever sends one is disconnected."""

JsonObject = dict[str, JsonValue]

RequestId = int | str


def _as_lists(value: object) -> object:
    """Return a value with lists in place of tuples, as `json.dumps` would write it."""
    if isinstance(value, dict):
        return {name: _as_lists(part) for name, part in value.items()}
    return [_as_lists(part) for part in value] if isinstance(value, list | tuple) else value


JsonData = Annotated[JsonObject, BeforeValidator(_as_lists)]
"""What a procedure stores and publishes; a third party's may hold tuples, which the store takes too."""


class MessageError(ValueError):
    """A line is no message of this protocol.

    Args:
        re: id of the request, as far as it could be read.
    """

    def __init__(self, text: str, re: RequestId | None = None) -> None:
        super().__init__(text)
        self.re = re


class Message(BaseModel):
    """A part of what the engine sends. What a newer engine adds is kept, and passed on by `attach --json`."""

    model_config = ConfigDict(frozen=True, extra="allow", ser_json_inf_nan="constants")

    def json_object(self) -> JsonObject:
        """Return it as JSON has it."""
        return self.model_dump(mode="json")


class Event(Message):
    """An event. Who publishes it stamps it: `stamped`.

    Attributes:
        t: ISO 8601 UTC time.
        event: its name.
        run: name of the run that it belongs to; None outside of one.
    """

    t: str = ""
    event: str
    run: str | None = None

    def stamped(self, t: str, run: str | None) -> Self:
        """Return it with time and run."""
        return self.model_copy(update={"t": t, "run": run})


def absent(value: object) -> bool:
    """Return whether a field is left out of the JSON; for `exclude_if` of fields that stand there only sometimes."""
    return value is None


def decode_object(line: bytes) -> dict[str, Any]:
    """Return the JSON object of a line.

    Raises:
        MessageError: the line is none.
    """
    try:
        message = json.loads(line)
    except (ValueError, RecursionError) as error:
        raise MessageError(f"this line is not JSON: {error}") from error
    if not isinstance(message, dict):
        raise MessageError("a message is a JSON object on a line of its own")
    return message


def encode_object(message: JsonObject) -> bytes:
    """Return an object as its line; everything beyond ASCII is escaped, so that any text can be sent."""
    return json.dumps(message).encode("ascii") + b"\n"


def require_version(message: dict[str, Any], re: RequestId | None = None) -> None:
    """Check that a message is of this version.

    Raises:
        MessageError: it is of another one, or of none.
    """
    version = message.get("v")
    if isinstance(version, bool) or version != VERSION:
        raise MessageError(
            f"the message is of version {json.dumps(version)} and this catseye speaks version {VERSION}: use the "
            "same catseye on both sides",
            re,
        )


def faults_of(error: ValidationError, skip: int = 0) -> str:
    """Return what is wrong with a message, in one line.

    Args:
        skip: parts of a place that name the model and not the field.
    """
    faults = []
    for fault in error.errors(include_url=False, include_input=False):
        place = ".".join(str(part) for part in fault["loc"][skip:])
        faults.append(f"{place}: {fault['msg']}" if place else str(fault["msg"]))
    return "; ".join(faults)

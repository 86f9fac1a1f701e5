"""Events on their way: from a message to the model that its name stands for, and back to a line."""

from collections.abc import Mapping
from typing import Any, Final, get_args

from pydantic import Field, ValidationError
from pydantic_core import PydanticSerializationError

from catseye.app.protocol.engine_events import EngineEvent
from catseye.app.protocol.message import VERSION, Event, MessageError, encode_object, faults_of
from catseye.app.protocol.run_events import PromptAsked, RunEvent


class Unknown(Event):
    """An event of a newer engine; whoever does not pass it on ignores it."""


class Unread(Event):
    """An event that this version knows by name and cannot read: an engine of another version says more in it.

    Attributes:
        unread_because: what this version cannot read.
    """

    unread_because: str = Field(exclude=True)


AnyEvent = RunEvent | EngineEvent | Unknown | Unread

_EVENTS: Final[Mapping[str, type[AnyEvent]]] = {
    str(model.model_fields["event"].default): model for model in (*get_args(RunEvent), *get_args(EngineEvent))
}


def event_of(message: Mapping[str, Any]) -> AnyEvent:
    """Return the event of a message.

    Raises:
        MessageError: it is no event as this version has it.
    """
    try:
        return _EVENTS.get(str(message.get("event")), Unknown).model_validate(message)
    except ValidationError as error:
        raise MessageError(f"{message.get('event')}: {faults_of(error)}") from error


def received_event(message: Mapping[str, Any]) -> AnyEvent:
    """Return the event of a message from an engine, which may be of another version: none cuts a client off.

    Raises:
        MessageError: it has no name, or a time or run that is no text.
    """
    try:
        return event_of(message)
    except MessageError as error:
        unread = {**message, "unread_because": str(error)}
    try:
        return Unread.model_validate(unread)
    except ValidationError as error:
        raise MessageError(f"{message.get('event')}: {faults_of(error)}") from error


def passed_over_text(event: Unknown | Unread) -> str:
    """Return what is said to a person of an event that is not shown."""
    if isinstance(event, Unknown):
        return f'"{event.event}" is unknown here: a newer engine sends it, and it is passed over; {_SAME}'
    if event.event == PromptAsked.model_fields["event"].default:
        return f"the engine asks something that this program cannot show ({event.unread_because}): {_SAME}"
    return f"the engine sent something that this program cannot read ({event.unread_because}): {_SAME}"


_SAME: Final = "use the same catseye on both sides"


def encode_event(event: Event) -> bytes:
    """Return an event as its line on the socket."""
    try:
        text = event.model_dump_json(ensure_ascii=True)
    except PydanticSerializationError:
        # A lone surrogate, as file names have them; Python's own writer escapes it.
        return encode_object({"v": VERSION, **event.json_object()})
    return f'{{"v":{VERSION},{text[1:]}\n'.encode("ascii")

"""Events on their way: from a message to the model that its name stands for, and back to a line."""

from collections.abc import Mapping
from typing import Any, Final, get_args

from pydantic import ValidationError
from pydantic_core import PydanticSerializationError

from catseye.app.protocol.engine_events import EngineEvent
from catseye.app.protocol.message import VERSION, Event, MessageError, encode_object, faults_of
from catseye.app.protocol.run_events import RunEvent


class Unknown(Event):
    """An event of a newer engine; whoever does not pass it on ignores it."""


AnyEvent = RunEvent | EngineEvent | Unknown

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


def encode_event(event: Event) -> bytes:
    """Return an event as its line on the socket."""
    try:
        text = event.model_dump_json(ensure_ascii=True)
    except PydanticSerializationError:
        # A lone surrogate, as file names have them; Python's own writer escapes it.
        return encode_object({"v": VERSION, **event.json_object()})
    return f'{{"v":{VERSION},{text[1:]}\n'.encode("ascii")

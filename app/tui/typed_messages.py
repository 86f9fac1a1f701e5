"""Dictionaries of the engine's client as models, until the client itself yields these."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from catseye.app.protocol.bench import BenchStatus
    from catseye.app.protocol.events import AnyEvent
    from catseye.app.protocol.snapshot import Snapshot


def typed_event(message: dict[str, Any]) -> "AnyEvent":
    """Return an event.

    Raises:
        ServiceError: it is none of this version.
    """
    from catseye.app.protocol.events import event_of
    from catseye.app.protocol.message import MessageError
    from catseye.app.service.errors import ServiceError

    try:
        return event_of(_completed(message))
    except MessageError as error:
        raise ServiceError(
            f"the engine sends what this program does not understand ({error}): engine and catseye tui have to be "
            "of the same version"
        ) from error


def typed_snapshot(message: dict[str, Any]) -> "Snapshot":
    """Return a snapshot.

    Raises:
        ServiceError: it is none of this version.
    """
    from pydantic import ValidationError

    from catseye.app.protocol.message import faults_of
    from catseye.app.protocol.snapshot import Snapshot
    from catseye.app.service.errors import ServiceError

    try:
        return Snapshot.model_validate(message)
    except ValidationError as error:
        raise ServiceError(
            f"engine and catseye tui have to be of the same version: {faults_of(error)}"
        ) from error


def typed_bench(message: dict[str, Any]) -> "BenchStatus":
    """Return the bench of an answer to `watch`."""
    from catseye.app.protocol.bench import BenchStatus

    return BenchStatus.model_validate(_completed({"event": "bench", **message}))


def _completed(message: dict[str, Any]) -> dict[str, Any]:
    """Add what the models say and the engine does not send yet."""
    match message:
        case {"event": "control", "by": str() as by} if "holder" not in message:
            return {**message, "holder": _client(by)}
        case {"event": "control"} if "holder" not in message:
            return {**message, "holder": None}
        case {"event": "raw" | "jog", "by": str() as by} if "client" not in message:
            return {**message, "client": _client(by)["client"]}
        case {"event": "bench", "devices": [*devices]}:
            return {**message, "devices": [_device(device) for device in devices]}
    return message


def _client(text: str) -> dict[str, str]:
    who, _, client = text.rpartition(" (")
    return {"client": client.removesuffix(")"), "who": who}


def _device(device: dict[str, Any]) -> dict[str, Any]:
    moves = device["name"] == "robot" or str(device["driver"]).startswith("melfa-")
    return {"moves_arm": moves, **device}

"""Signals, event log, files, message queues, users: what does not concern the arm."""

from typing import Final

from catseye.simulators.abb.calls import GRANTED_AFTER_S, Call
from catseye.simulators.abb.events import Event
from catseye.simulators.abb.http import Answer
from catseye.simulators.abb.replies import (
    NO_VALUE,
    NOT_FOUND,
    NOTHING,
    QUEUE_EXISTS,
    REFUSED,
    RefusedError,
    State,
)

RAMDISK: Final = "/hd0a/EMULATOR/ramdisk"
_MOST: Final = 1000
_MOST_FILE_BYTES: Final = 16 << 20
_MESSAGE: Final = ("dipc-data", "dipc-userdef", "dipc-msgtype", "dipc-cmd")


def signal(call: Call) -> Answer:
    """Return a signal; one that nobody has set is 0."""
    return call.said(signal_state(call, call.parts[0]))


def signal_state(call: Call, place: str) -> State:
    """Return a signal by network, unit and name."""
    fields = {"name": place.rpartition("/")[2], "lvalue": call.controller.signals.get(place, "0")}
    return State("ios-signal", place, fields)


def set_signal(call: Call) -> Answer:
    """Set a signal."""
    text, signals = call.value("lvalue"), call.controller.signals
    try:
        float(text)
    except ValueError:
        raise RefusedError(400, NO_VALUE, f"{text[:40]} is no value of a signal") from None
    call.require_mode()
    if call.parts[0] not in signals and len(signals) >= _MOST:
        raise RefusedError(403, REFUSED, "there are too many signals")
    signals[call.parts[0]] = text
    return NOTHING


def event_log(call: Call) -> Answer:
    """Return the events of domain 0, the newest first."""
    if call.parts != ("0",):
        raise RefusedError(404, NOT_FOUND, f"there is no event log {call.parts[0]}")
    return call.said(*map(_event, call.controller.events.newest_first()))


def _event(event: Event) -> State:
    fields = {
        "msgtype": str(event.kind),
        "code": str(event.code),
        "src-name": "EMULATOR",
        "tstamp": event.time,
        "title": event.title,
        "desc": event.title,
        "conseqs": "",
        "causes": "",
        "actions": "",
        "argc": "0",
        "argv": [],
    }
    return State("elog-message-li", f"/rw/elog/0/{event.number}", fields)


def ramdisk(call: Call) -> Answer:
    """Return the value of $RAMDISK."""
    return call.said(State("ctrl-env", "$RAMDISK", {"_value": RAMDISK}))


def read_file(call: Call) -> Answer:
    """Return a file, or what is in a folder."""
    files, path = call.controller.files, call.parts[0].strip("/")
    if path in files:
        return Answer(200, files[path], "application/octet-stream")
    inside = f"{path}/"
    names = sorted({name[len(inside) :].partition("/")[0] for name in files if name.startswith(inside)})
    if not names and "/" in path:
        raise RefusedError(404, NOT_FOUND, f"there is no file {path}")
    return call.said(*(_file(call, inside, name) for name in names))


def _file(call: Call, inside: str, name: str) -> State:
    content = call.controller.files.get(inside + name)
    if content is None:
        return State("fs-dir", name)
    return State("fs-file", name, {"fs-size": str(len(content)), "fs-readonly": "false"})


def write_file(call: Call) -> Answer:
    """Write a file."""
    files, path, content = call.controller.files, call.parts[0].strip("/"), call.request.body
    kept = sum(map(len, files.values()))
    if len(files) >= _MOST or kept + len(content) > _MOST_FILE_BYTES:
        raise RefusedError(403, REFUSED, "the disk is full")
    files[path] = content
    return Answer(201)


def delete_file(call: Call) -> Answer:
    """Delete a file."""
    if call.controller.files.pop(call.parts[0].strip("/"), None) is None:
        raise RefusedError(404, NOT_FOUND, f"there is no file {call.parts[0]}")
    return NOTHING


def create_queue(call: Call) -> Answer:
    """Make a message queue."""
    queues, name = call.controller.queues, call.value("dipc-queue-name")
    if name in queues:
        raise RefusedError(400, QUEUE_EXISTS, f"there is a queue {name} already")
    if len(queues) >= _MOST:
        raise RefusedError(403, REFUSED, "there are too many queues")
    queues[name] = []
    return Answer(201)


def send_message(call: Call) -> Answer:
    """Put a message into a queue."""
    messages = _queue(call)
    if len(messages) >= _MOST:
        raise RefusedError(403, REFUSED, f"the queue {call.parts[0]} is full")
    messages.append({name: call.value(name) for name in _MESSAGE})
    return NOTHING


def read_messages(call: Call) -> Answer:
    """Take the messages out of a queue."""
    messages = _queue(call)
    found, messages[:] = list(messages), []
    named = [{**message, "queue-name": call.parts[0]} for message in found]
    return call.said(*(State("dipc-read-li", call.parts[0], message) for message in named))


def _queue(call: Call) -> list[dict[str, str]]:
    name = call.parts[0]
    if name not in call.controller.queues:
        raise RefusedError(404, NOT_FOUND, f"there is no queue {name}")
    return call.controller.queues[name]


def request_remote_control(call: Call) -> Answer:
    """Ask the pendant for the right to write in manual mode, or give it back."""
    if call.request.query.get("action") == "cancel":
        call.login.rmmp_s = None
    else:
        call.login.rmmp_s = call.now_s + GRANTED_AFTER_S
    return NOTHING


def poll_remote_control(call: Call) -> Answer:
    """Return whether the pendant has granted it."""
    asked_s = call.login.rmmp_s
    status = "NONE" if asked_s is None else "GRANTED" if asked_s <= call.now_s else "PENDING"
    return call.said(State("user-rmmp-poll", "rmmp", {"status": status}))

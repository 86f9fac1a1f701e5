"""Requests to an engine, and what becomes of them in hostile hands."""

import json
import random
from typing import Any, Final

from tests.fuzz.mutation import mutated, mutated_document

VALID: Final[tuple[dict[str, Any], ...]] = (
    {"op": "hello", "client": "test-1", "who": "Ada"},
    {"op": "control", "take": True, "force": False},
    {"op": "hand-over", "to": "test-2"},
    {"op": "ping"},
    {"op": "hold"},
    {"op": "answer", "prompt": "beam/P1/0042", "text": "retry"},
    {"op": "override", "percent": 5.0},
    {"op": "start", "procedure": "open-loop", "params": {"reflectors": ["P1"]}, "job": "night-1"},
    {"op": "resume", "run": "20260101T000000Z_open-loop_1a2b3c"},
    {"op": "watch", "on": True},
    {"op": "traffic", "on": True},
    {"op": "jog", "on": True, "percent": 5.0},
    {"op": "jog-step", "joint": "j1", "by": 0.5},
    {"op": "jog-hold", "joint": "j1", "direction": 1},
    {"op": "walk-feed", "on": True},
    {"op": "emulate", "speed": 10.0},
    {"op": "reset-alarm", "number": 4140, "text": "a text"},
    {"op": "restore-override", "percent": 20.0},
    {"op": "raw", "device": "robot", "on": True},
    {"op": "send", "device": "robot", "hex": "312e"},
)
PATHS: Final = ("../../etc/passwd", "/etc/passwd", "a\0b", "x" * 5000, "..", "/", "~root", "\udc80")
"""In place of names of runs, cells and files."""


def request(fields: dict[str, Any], number: int = 1) -> bytes:
    """Return a request as its line."""
    return json.dumps({"v": 1, "id": number, **fields}).encode() + b"\n"


def hostile_line(numbers: random.Random) -> bytes:
    """Return a line: a request with other values, with other bytes, or none at all."""
    fields = numbers.choice(VALID)
    match numbers.randrange(4):
        case 0:
            changed = mutated_document(fields, numbers)
            return request(changed) if isinstance(changed, dict) else json.dumps(changed).encode() + b"\n"
        case 1:
            texts = [key for key, value in fields.items() if isinstance(value, str) and key != "op"]
            return request({**fields, **{key: numbers.choice(PATHS) for key in texts}})
        case 2:
            return mutated(request(fields), numbers).replace(b"\n", b" ") + b"\n"
        case _:
            return numbers.randbytes(numbers.randint(1, 200)).replace(b"\n", b" ") + b"\n"

"""Texts of RAPID values, and the states that answers hold."""

import json
import math
import re
from collections.abc import Mapping
from typing import Any, Final

from catseye.drivers.abb.http import Answer
from catseye.drivers.roles.errors import ProtocolError
from catseye.drivers.roles.pose import Pose

JOINTS: Final = tuple(f"rax_{number}" for number in range(1, 7))
"""Joints of the arm in an answer, in the order of a pose."""

UNUSED: Final = "9E9"
"""External axes of a goal: CATSABB leaves them where they are."""

_NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?")
_SHOWN: Final = 80

State = Mapping[str, Any]


def number_of(text: object) -> float:
    """Return a num.

    Raises:
        ProtocolError: it is no finite number.
    """
    # `float` strips less than `strip` does.
    digits = text.strip() if isinstance(text, str) else ""
    if _NUMBER.fullmatch(digits) and math.isfinite(value := float(digits)):
        return value
    raise ProtocolError(f"{str(text)[:_SHOWN]!r} is not a number")


def whole_of(text: object) -> int:
    """Return a whole num.

    Raises:
        ProtocolError: it is none.
    """
    value = number_of(text)
    if value != int(value):
        raise ProtocolError(f"{str(text)[:_SHOWN]!r} is not a whole number")
    return int(value)


def goal_text(target: Pose) -> str:
    """Return a jointtarget: six joints, deg, finer than the 32 bits of a num resolve."""
    joints = ",".join(f"{value:.7f}" for value in target)
    return f"[[{joints}],[{','.join([UNUSED] * len(JOINTS))}]]"


def states_of(answer: Answer) -> list[State]:
    """Return the states of an answer.

    Raises:
        ProtocolError: it holds none.
    """
    states = _embedded(answer).get("_state")
    if not isinstance(states, list) or not all(isinstance(state, dict) for state in states):
        raise ProtocolError("the answer has no list of states")
    return states


def value_of(answer: Answer, name: str) -> str:
    """Return a field of the first state of an answer.

    Raises:
        ProtocolError: there is no such field, or it is no text.
    """
    states = states_of(answer)
    value = states[0].get(name) if states else None
    if not isinstance(value, str):
        raise ProtocolError(f"the answer has no {name}")
    return value


def error_of(answer: Answer) -> tuple[int, str]:
    """Return number and text of an error; the status where the answer says no more."""
    try:
        status = _embedded(answer).get("status")
        if isinstance(status, dict):
            return int(status.get("code", answer.status)), str(status.get("msg", ""))[:_SHOWN]
    except (ProtocolError, TypeError, ValueError, OverflowError):
        pass
    return answer.status, ""


def _embedded(answer: Answer) -> Mapping[str, Any]:
    try:
        document = json.loads(answer.body)
    except (ValueError, RecursionError):
        raise ProtocolError(f"the answer is not JSON: {answer.body[:_SHOWN]!r}") from None
    embedded = document.get("_embedded") if isinstance(document, dict) else None
    if not isinstance(embedded, dict):
        raise ProtocolError("the answer is not a resource of Robot Web Services")
    return embedded

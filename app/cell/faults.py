"""What is wrong with a key of a file, in words."""

from collections.abc import Callable

from pydantic_core import ErrorDetails

_SHOWN_LENGTH = 200
"""Of a wrong value."""


def fault_text(fault: ErrorDetails, unknown: Callable[[], str]) -> str:
    """Return what is wrong with one key.

    Args:
        unknown: returns what there is to say of a key that is not known.
    """
    match fault["type"]:
        case "extra_forbidden":
            return unknown()
        case "missing":
            return "this key is missing"
        case "value_error":
            return fault["msg"].removeprefix("Value error, ")
        case "too_short" | "too_long":
            wanted = fault["ctx"].get("min_length", fault["ctx"].get("max_length"))
            return f"give {wanted} values, not {fault['ctx']['actual_length']}: {_shown(fault['input'])}"
        case _:
            return f"{fault['msg']}, not {_shown(fault['input'])}"


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= _SHOWN_LENGTH else f"{text[:_SHOWN_LENGTH]}…"

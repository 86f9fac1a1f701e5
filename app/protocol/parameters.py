"""What a parameter of a procedure may be, in words; and what is wrong with a text that is typed for one."""

import json
import math
from pathlib import Path
from typing import Any, Final

from catseye.app.errors import ConfigError
from catseye.app.files.documents import parse_toml

_KINDS = {"integer": "a whole number", "number": "a number", "boolean": "true or false", "string": "a name"}


def parameter_label(name: str, facts: dict[str, Any]) -> str:
    """Return what a parameter is called on screens, with its unit.

    Args:
        name: its key, as `--param` takes it.
        facts: its JSON schema.
    """
    return str(facts.get("title", name))


_LOW: Final = {"minimum": "≥ ", "exclusiveMinimum": "> "}
_HIGH: Final = {"maximum": "≤ ", "exclusiveMaximum": "< "}
_ENDS: Final = {
    "minimum": "at least",
    "exclusiveMinimum": "more than",
    "maximum": "at most",
    "exclusiveMaximum": "less than",
}
"""Ends of a range, as JSON schemas name them."""


def range_text(facts: dict[str, Any]) -> str:
    """Return what a parameter may be.

    Args:
        facts: the parameter's JSON schema.
    """
    if "anyOf" in facts:
        return ", or ".join(range_text(one) for one in facts["anyOf"] if one.get("type") != "null")
    if "file" in facts:
        return "the name of a file"
    if "enum" in facts:
        return " or ".join(str(one) for one in facts["enum"])
    if facts.get("type") == "array":
        return _list_text(facts)
    kind = _KINDS.get(str(facts.get("type")), "a value")
    if not (ends := {key: facts[key] for key in _ENDS if key in facts}):
        return kind
    whole = f"{kind}, " if facts.get("type") == "integer" else ""
    if ends.keys() == {"minimum", "maximum"}:
        return f"{whole}{ends['minimum']:g} … {ends['maximum']:g}"
    return whole + ", ".join(f"{_ENDS[key]} {end:g}" for key, end in ends.items())


def short_text(facts: dict[str, Any]) -> str:
    """Return what a parameter may be in few characters, for one line of a form.

    Args:
        facts: the parameter's JSON schema.
    """
    facts = next((one for one in facts.get("anyOf", [facts]) if one.get("type") != "null"), facts)
    if takes_names(facts):
        return "names, by commas"
    low = [sign + f"{facts[key]:g}" for key, sign in _LOW.items() if key in facts]
    high = [sign + f"{facts[key]:g}" for key, sign in _HIGH.items() if key in facts]
    if low and high:
        return f"{low[0].removeprefix('≥ ')} … {high[0].removeprefix('≤ ')}"
    return "".join(low or high) or range_text(facts)


def _list_text(facts: dict[str, Any]) -> str:
    items, fewest, most = facts.get("items", {}), facts.get("minItems"), facts.get("maxItems")
    if items.get("type") == "string":
        return "names, separated by commas"
    if items.get("type") == "array":
        return f"a list of {fewest} to {most} such pairs: {range_text(items)}"
    return f"[{', '.join([range_text(items)] * int(fewest or 1))}]"


def default_text(facts: dict[str, Any]) -> str:
    """Return a parameter's default as it is typed; empty when it is chosen by the program."""
    return value_text(facts.get("default"))


def value_text(value: object) -> str:
    """Return a value as it is typed; empty for nothing, an empty text and an empty list."""
    match value:
        case None | "" | []:
            return ""
        case bool():
            return str(value).lower()
        case int() | float():
            return f"{value:g}"
        case str():
            return value
    return json.dumps(value, ensure_ascii=False)


def typed_fault(facts: dict[str, Any], text: str) -> str:
    """Return why a typed text cannot be a parameter's value, as far as its JSON schema says; empty when it can.

    Args:
        facts: the parameter's JSON schema.
        text: as typed; an empty one leaves the parameter at its default.
    """
    text = text.strip()
    if not text or "file" in facts or any(_fits(one, text) for one in facts.get("anyOf", [facts])):
        return ""
    return range_text(facts)


def param_text(facts: dict[str, Any], name: str, text: str) -> str:
    """Return what is typed for a parameter as `--param` takes it.

    Names need no quotes, lists of names no brackets, and a file is named from here.

    Args:
        facts: the parameter's JSON schema.
        text: without a fault.
    """
    text = text.strip()
    if "file" in facts:
        return f"{name}={json.dumps(str(Path(text).expanduser().absolute()), ensure_ascii=False)}"
    kinds = {one.get("type") for one in facts.get("anyOf", [facts])}
    if kinds <= {"string", "null"}:
        return f"{name}={json.dumps(text, ensure_ascii=False)}"
    if takes_names(facts) and not text.startswith("["):
        return f"{name}={json.dumps(names_in(text), ensure_ascii=False)}"
    return f"{name}={text}"


def _fits(facts: dict[str, Any], text: str) -> bool:
    match facts.get("type"):
        case "integer":
            return text.lstrip("+-").isdigit() and _in_range(facts, float(text))
        case "number":
            return _in_range(facts, _number(text))
        case "boolean":
            return text in {"true", "false"}
        case "array":
            return (takes_names(facts) and not text.startswith("[")) or _is_list(facts, text)
        case "null":
            return False
    return "enum" not in facts or text in facts["enum"]


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan


def _in_range(facts: dict[str, Any], value: float) -> bool:
    return (
        math.isfinite(value)
        and facts.get("minimum", -math.inf) <= value <= facts.get("maximum", math.inf)
        and facts.get("exclusiveMinimum", -math.inf) < value < facts.get("exclusiveMaximum", math.inf)
    )


def takes_names(facts: dict[str, Any]) -> bool:
    """Return whether a parameter is a list of names; they may be typed without brackets.

    Args:
        facts: the parameter's JSON schema.
    """
    one: dict[str, Any] = next((one for one in facts.get("anyOf", [facts]) if one.get("type") == "array"), {})
    return bool(one.get("items", {}).get("type") == "string")


def names_in(text: str) -> list[str]:
    """Return names that are separated by commas, or stand in a list without a fault."""
    if text.strip().startswith("["):
        return [str(name) for name in parse_toml(f"value = {text}", "")["value"]]
    return [part.strip() for part in text.split(",") if part.strip()]


def _is_list(facts: dict[str, Any], text: str) -> bool:
    try:
        value = parse_toml(f"value = {text}", "")["value"]
    except ConfigError:
        return False
    return isinstance(value, list) and _list_fits(facts, value)


def _list_fits(facts: dict[str, Any], values: list[Any]) -> bool:
    if not facts.get("minItems", 0) <= len(values) <= facts.get("maxItems", math.inf):
        return False
    items = facts.get("items", {})
    return all(_item_fits(items, value) for value in values)


def _item_fits(facts: dict[str, Any], value: object) -> bool:
    match facts.get("type"):
        case "array":
            return isinstance(value, list) and _list_fits(facts, value)
        case "string":
            return isinstance(value, str)
    return _fits(facts, value_text(value))

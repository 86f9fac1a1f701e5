"""What a parameter of a procedure may be, in words."""

from typing import Any

_KINDS = {"integer": "a whole number", "number": "a number", "boolean": "true or false", "string": "a name"}


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
    low, high = facts.get("minimum"), facts.get("maximum")
    above = facts.get("exclusiveMinimum")
    kind = _KINDS.get(str(facts.get("type")), "a value")
    if low is None and above is None and high is None:
        return kind
    whole = f"{kind}, " if facts.get("type") == "integer" else ""
    if above is not None:
        return f"{whole}more than {above:g}, at most {high:g}"
    return f"{whole}{low:g} … {high:g}"


def _list_text(facts: dict[str, Any]) -> str:
    items, fewest, most = facts.get("items", {}), facts.get("minItems"), facts.get("maxItems")
    if items.get("type") == "string":
        return 'a list of names, such as ["P1", "P2"]'
    if items.get("type") == "array":
        return f"a list of {fewest} to {most} such pairs: {range_text(items)}"
    return f"[{', '.join([range_text(items)] * int(fewest or 1))}]"

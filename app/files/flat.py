"""A configuration's leaves by dotted key."""

from typing import Any


def flattened(value: Any, key: str = "") -> dict[str, Any]:
    """Return the leaves of a configuration by dotted key; [[tables]] are counted from 1, as people count."""
    if isinstance(value, dict):
        parts = [(f"{key}.{name}" if key else str(name), part) for name, part in value.items()]
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        parts = [(f"{key}[{number}]", part) for number, part in enumerate(value, 1)]
    else:
        return {key: value}
    return {leaf: found for name, part in parts for leaf, found in flattened(part, name).items()}

"""Which procedures are installed; light enough for the completion of a shell."""

from importlib import metadata
from typing import Final

GROUP: Final = "catseye.procedures"
"""Of the entry points by which procedures register."""


def procedure_names() -> tuple[str, ...]:
    """Return the names of all installed procedures; imports none of them."""
    return tuple(sorted({entry.name for entry in metadata.entry_points(group=GROUP)}))

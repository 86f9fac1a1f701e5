"""What `catseye procedures --json` writes, as the screen needs it."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Final

SIGNS: Final = {"met": "✓", "advised": "!", "missing": "✗"}
STYLES: Final = {"met": "$success", "advised": "$warning", "missing": "$error"}
STAGE_SIGNS: Final = {"done": "✓", "next": "→", "later": "·", "left out": "–"}


@dataclass(frozen=True)
class Catalogue:
    """All procedures on one cell.

    Attributes:
        cell: its name; empty where no cell file was given.
        procedures: facts by name, in the order of the command.
        stages: on the way to a validated error map.
    """

    cell: str = ""
    procedures: dict[str, dict[str, Any]] = field(default_factory=dict)
    stages: list[dict[str, Any]] = field(default_factory=list)

    @classmethod
    def of(cls, lines: Sequence[dict[str, Any]]) -> "Catalogue":
        """Return what the lines of the command hold."""
        named = {str(each["name"]): each for each in lines if "name" in each}
        about = next((each for each in lines if "stages" in each), {})
        return cls(str(about.get("cell", "")), named, list(about.get("stages", [])))

    @property
    def next(self) -> dict[str, Any] | None:
        """The next sensible stage."""
        return next((stage for stage in self.stages if stage["state"] == "next"), None)

    def worst(self, name: str) -> str:
        """Return whether everything that a procedure needs is met, in the word of what is not."""
        found = {need["met"] for need in self.procedures[name].get("needs", [])}
        return next((word for word in ("missing", "advised") if word in found), "met")


def with_run_fields(facts: dict[str, Any], speed: float, *, real: bool) -> dict[str, Any]:
    """Return the parameters of a procedure and what else a start may choose.

    Args:
        facts: of the procedure.
        speed: bench seconds in one real second, where nothing is typed.
        real: the devices are real: their time runs as it runs.
    """
    fields = dict(facts["params"])
    if facts["needs_aim"]:
        fields["search"] = {
            "type": "string",
            "default": "auto",
            "description": "aim: auto takes the newest search of this cell, none the cell file, or a run's name",
        }
    if not real:
        fields["speed"] = {
            "type": "number",
            "default": speed,
            "minimum": 0.001,
            "maximum": 1e6,
            "description": "bench seconds in one real second, for emulators",
        }
    return fields

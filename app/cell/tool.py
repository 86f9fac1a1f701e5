"""Descriptions of tools, `catseye-tool/1`: mass, and targets that an instrument sees, in the frame of the flange."""

from importlib.resources import files
from pathlib import Path
from typing import Final, Literal, Self

from pydantic import Field, model_validator

from catseye.app.cell.arm import Triple
from catseye.app.cell.described import Shipped, read_described
from catseye.app.cell.section import Finite, Name, NotNegative, Section, require_own_names


class Target(Section):
    """[[target]]: a point of the tool; a retroreflector also has the direction in which it looks.

    Attributes:
        u_mm: standard uncertainty of each coordinate; with 0 a calibration takes the place as exact.
    """

    name: Name
    x_mm: Finite
    y_mm: Finite
    z_mm: Finite
    normal: Triple | None = None
    u_mm: NotNegative = 0.0

    @model_validator(mode="after")
    def _looks_somewhere(self) -> Self:
        if self.normal is not None and not any(self.normal):
            raise ValueError(
                f"[[target]] {self.name}: normal = [0, 0, 0] is not a direction: leave it out, or state it"
            )
        return self


class ToolDescription(Section):
    """A whole description; the frame of the flange is the last one of the arm."""

    format: Literal["catseye-tool/1"]
    name: str
    mass_kg: NotNegative
    centre_mm: Triple
    target: list[Target] = Field(default_factory=list)

    @model_validator(mode="after")
    def _unique_targets(self) -> Self:
        require_own_names("[[target]]", [target.name for target in self.target])
        return self

    def place_mm(self, target: str) -> tuple[float, float, float]:
        """Return where a target is in the frame of the flange.

        Raises:
            ValueError: the tool has no such target.
        """
        found = next((one for one in self.target if one.name == target), None)
        if found is None:
            names = ", ".join(one.name for one in self.target) or "none"
            raise ValueError(f"the tool {self.name} has no target {target}; it has {names}")
        return found.x_mm, found.y_mm, found.z_mm


_SHIPPED: Final = Shipped(ToolDescription, "a tool", files("catseye.app.cell") / "tools")


def shipped_tools() -> list[str]:
    """Return the names of the tools that are described."""
    return _SHIPPED.names()


def tool_description(tool: str | ToolDescription) -> ToolDescription:
    """Return the description of a tool.

    Args:
        tool: name of a shipped tool, or path of a file; a description is returned as it is.

    Raises:
        ConfigError: the file cannot be read or is no description; the fault is named with its key.
        ValueError: there is no such tool.
    """
    return _SHIPPED.of(tool)


def read_tool(path: Path) -> ToolDescription:
    """Read a tool.

    Raises:
        ConfigError: the file cannot be read or is no description; the fault is named with its key.
    """
    return read_described(ToolDescription, path)

"""Poses that are taken together have to be of one arm with one tool."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from catseye.app.cell.arm import ArmDescription, arm_description
from catseye.app.cell.serial_arm import chain_of, loads_of
from catseye.app.cell.tool import ToolDescription
from catseye.app.errors import UsageError
from catseye.app.results.runs.run_source import cell_of_run
from catseye.app.results.serial_arm.result import SerialArmResult
from catseye.app.store.reader import RunReader

_TABLE: Final = "export its poses (catseye export) and name the table"


def require_one_subject(readers: Sequence[RunReader], *, arm_stated: bool, tool_stated: bool) -> None:
    """Refuse runs of several arms or tools.

    Args:
        readers: of the runs.
        arm_stated: somebody states which arm all of them are of.
        tool_stated: the same of the tool.

    Raises:
        UsageError: two runs differ in what nobody states.
    """
    robots = [(reader.path.name, cell_of_run(reader).robot) for reader in readers]
    for name, robot in robots[1:]:
        first, other = robots[0]
        if not arm_stated:
            _require_arm(robot.arm, other.arm, name, first, "state --arm")
        if not tool_stated:
            _require_tool(robot.carried, other.carried, name, first, "state --tool")


def require_subject_of(result: SerialArmResult, reader: RunReader) -> None:
    """Refuse a run of another arm or tool than a result's; a result of targets at unknown places has no tool.

    Raises:
        UsageError: they differ.
    """
    robot, name = cell_of_run(reader).robot, reader.path.name
    _require_arm(robot.arm, result.description or result.arm, name, "the result", _TABLE)
    if result.tool is not None:
        _require_tool(robot.carried, result.tool, name, "the result", _TABLE)


def _require_arm(
    one: str | ArmDescription, other: str | ArmDescription, name: str, against: str, remedy: str
) -> None:
    arms = arm_description(one), arm_description(other)
    if _of_arm(arms[0]) != _of_arm(arms[1]):
        raise UsageError(
            f"{name} is of another arm than {against}: {arms[0].name}, not {arms[1].name}, or with other dimensions; "
            f"take them apart, or, if the same arm is described again, {remedy}"
        )


def _require_tool(
    one: ToolDescription | None, other: ToolDescription | None, name: str, against: str, remedy: str
) -> None:
    if _of_tool(one) != _of_tool(other):
        names = ["no tool" if tool is None else tool.name for tool in (one, other)]
        raise UsageError(
            f"{name} was measured with another tool than {against}: {names[0]}, not {names[1]}, or with other places "
            f"of targets; take them apart, or, if the same tool is described again, {remedy}"
        )


def _of_arm(arm: ArmDescription) -> object:
    """Return what a calibration depends on: ranges may have been narrowed."""
    return [replace(joint, low=0.0, high=0.0) for joint in chain_of(arm).joints], loads_of(arm)


def _of_tool(tool: ToolDescription | None) -> object:
    """Return what a calibration depends on: where targets look does not matter."""
    if tool is None:
        return None
    return tool.mass_kg, tool.centre_mm, {one.name: tool.place_mm(one.name) for one in tool.target}

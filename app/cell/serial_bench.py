"""The bench of a serial arm with a tracker, from its sections of a cell file."""

from dataclasses import fields
from typing import cast

from catseye.app.cell.arm import arm_description
from catseye.app.cell.model import Cell
from catseye.app.cell.serial_arm import loads_of, point_of
from catseye.app.cell.tool import Target, ToolDescription
from catseye.app.cell.tracker import Tracker
from catseye.app.errors import ConfigError
from catseye.drivers.roles.registry import load_driver
from catseye.drivers.roles.tracker import Place, TrackerAbilities, TrackerClass
from catseye.procedures.kit.bench import Bench
from catseye.procedures.serial_arm.bench import Ballbar, FixedNest, Instrument, SerialBench, ToolTarget


def missing_of_serial(cell: Cell) -> list[str]:
    """Return what a cell file lacks for measuring targets of a serial arm."""
    tracker = cell.tracker
    if tracker is None:
        lacks = ["[tracker]"]
    else:
        stated = {"base_mm": tracker.base_mm, "base_deg": tracker.base_deg}
        lacks = [f"{key} in [tracker]" for key, value in stated.items() if value is None]
    return lacks if cell.robot.carried is not None else [*lacks, "tool in [robot]"]


def serial_bench(bench: Bench, cell: Cell) -> SerialBench:
    """Return a bench with what is known of targets and instrument.

    Args:
        cell: that lacks nothing of it.

    Raises:
        ConfigError: the driver of the tracker is not installed.
    """
    tracker, tool = cast("Tracker", cell.tracker), cast("ToolDescription", cell.robot.carried)
    return SerialBench(
        **{each.name: getattr(bench, each.name) for each in fields(Bench)},
        instrument=Instrument(
            abilities=tracker_abilities(tracker),
            base_mm=point_of(tracker.base_mm or []),
            base_deg=point_of(tracker.base_deg or []),
            cone_deg=tracker.cone_deg,
            face_deg=tracker.face_deg,
            nests=tuple(FixedNest(one.name, (one.x_mm, one.y_mm, one.z_mm)) for one in tracker.nest),
        ),
        targets=tuple(map(_target, tool.target)),
        loads=loads_of(arm_description(cell.robot.arm), tool),
        ballbar=_ballbar(cell),
    )


def tracker_abilities(tracker: Tracker) -> TrackerAbilities:
    """Return what the driver of a tracker is able to do.

    Raises:
        ConfigError: no such driver is installed, or it is none of a tracker.
    """
    try:
        return cast("type[TrackerClass]", load_driver(tracker.driver, "tracker")).abilities
    except LookupError as error:
        raise ConfigError(f"[tracker] driver: {error.args[0]}") from error


def _target(target: Target) -> ToolTarget:
    normal: Place | None = None if target.normal is None else point_of(target.normal)
    return ToolTarget(target.name, (target.x_mm, target.y_mm, target.z_mm), normal)


def _ballbar(cell: Cell) -> Ballbar | None:
    if cell.ballbar is None:
        return None
    stated = cell.ballbar
    return Ballbar(
        stated.length_mm, stated.range_mm, stated.u_length_mm, point_of(stated.centre_mm), stated.radius_mm
    )

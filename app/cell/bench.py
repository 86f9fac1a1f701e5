"""The bench and the system that a cell file describes."""

from collections.abc import Sequence

from catseye.app.cell.axes import arm_of
from catseye.app.cell.bodies import workspace_of
from catseye.app.cell.model import Cell
from catseye.app.cell.scara.bench import scara_bench, stated_arm
from catseye.app.cell.scara.sections import ScaraSections, open_loop_keys
from catseye.app.cell.serial_bench import missing_of_serial, serial_bench, tracker_abilities
from catseye.app.errors import ConfigError
from catseye.procedures.kit.bench import AngularOptics, Bench, LinearOptics, Timing
from catseye.procedures.kit.needs import Needs, TrackerAbility
from catseye.procedures.kit.system import System
from catseye.procedures.kit.tasks import OpticsKind
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.system import ScaraSystem
from catseye.procedures.serial_arm.bench import SerialBench


def bench_of(cell: Cell) -> Bench:
    """Return the bench that a cell file describes, as far as it does."""
    bench, scara = _bench(cell), stated_scara_sections(cell)
    if not scara.missing:
        return scara_bench(bench, scara)
    return bench if missing_of_serial(cell) else serial_bench(bench, cell)


def scara_bench_of(cell: Cell, wanted_by: str = "open-loop tracking") -> ScaraBench:
    """Return the bench of a SCARA with its interferometer.

    Args:
        cell: that describes it.

    Raises:
        ConfigError: names what the cell file does not have.
    """
    return scara_bench(_bench(cell), scara_sections(cell, wanted_by))


def scara_sections(cell: Cell, wanted_by: str) -> ScaraSections:
    """Return what open-loop tracking takes from a cell file; see `scara_bench_of`."""
    found = stated_scara_sections(cell)
    _require_none(found.missing, cell, wanted_by)
    return found


def stated_scara_sections(cell: Cell) -> ScaraSections:
    """Return what open-loop tracking takes from a cell file; it says what is missing."""
    return ScaraSections(
        cell.robot,
        cell.optics,
        cell.alignment,
        cell.reflector,
        cell.measurement,
        cell.uncertainty,
        cell.plausibility,
    )


def unread_keys(cell: Cell) -> tuple[str, ...]:
    """Return sections and keys whose defaults nothing on this bench reads: those of a beam where there is none."""
    return () if cell.interferometer is not None else ("air", *open_loop_keys())


def bench_for(cell: Cell, needs: Needs, wanted_by: str) -> Bench:
    """Return the bench that a procedure is planned on.

    Args:
        cell: that describes it.

    Raises:
        ConfigError: names every section and key that the cell file does not have.
    """
    of_bench = _missing_of(cell, needs.bench)
    devices = [f"[{role}]" for role in needs.roles if role not in cell.instruments]
    optics = [f"[{kind}_optics]" for kind in needs.optics if kind not in optics_of(cell)]
    _require_none([*of_bench, *devices, *optics], cell, wanted_by)
    _require_able(cell, needs.tracker, wanted_by)
    return bench_of(cell)


def _missing_of(cell: Cell, bench: type[Bench]) -> list[str]:
    if issubclass(bench, ScaraBench):
        return stated_scara_sections(cell).missing
    return missing_of_serial(cell) if issubclass(bench, SerialBench) else []


def _require_able(cell: Cell, wanted: Sequence[TrackerAbility], wanted_by: str) -> None:
    if not wanted or cell.tracker is None:
        return
    able = tracker_abilities(cell.tracker).named()
    if not set(wanted) & set(able):
        raise ConfigError(
            f"{wanted_by} needs a tracker that measures {' or '.join(wanted)}, and the driver {cell.tracker.driver} "
            f"measures {', '.join(able) or 'neither'}: choose another driver in [tracker] of {cell.name}"
        )


def optics_of(cell: Cell) -> tuple[OpticsKind, ...]:
    """Return the kinds of optics that a cell file has beside those of open-loop tracking."""
    kinds: dict[OpticsKind, object] = {"angular": cell.angular_optics, "linear": cell.linear_optics}
    return tuple(kind for kind, section in kinds.items() if section is not None)


def system_of(bench: Bench) -> System:
    """Return what there is to ask of a bench."""
    return ScaraSystem(bench) if isinstance(bench, ScaraBench) else System(bench)


def _require_none(missing: Sequence[str], cell: Cell, wanted_by: str) -> None:
    if missing:
        raise ConfigError(f"{wanted_by} needs {', '.join(missing)}: add them to the cell file {cell.name}")


def _bench(cell: Cell) -> Bench:
    timing, angular, linear = cell.measurement, cell.angular_optics, cell.linear_optics
    return Bench(
        name=cell.name,
        arm=stated_arm(arm_of(cell.robot), cell.robot),
        workspace=workspace_of(cell),
        timing=Timing(
            timing.settle_time_s, timing.dwell_time_s, timing.readings, timing.spread_limit_um * 1e-3
        ),
        tracker=cell.tracker is not None,
        angular_optics=None if angular is None else AngularOptics(**angular.model_dump()),
        linear_optics=None if linear is None else LinearOptics(**linear.model_dump()),
    )

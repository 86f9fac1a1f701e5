"""The calibrated arm of a result, which commands of a ballbar and the place of its cup are found by."""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

from catseye.calibration.kinematics.errors import KinematicsError
from catseye.calibration.kinematics.gravity import Load
from catseye.procedures.kit.columns import DocumentRule
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.serial_arm.bench import SerialBench, ToolTarget

if TYPE_CHECKING:
    from catseye.calibration.serial_arm.geometry import Geometry

RESULT: Final = DocumentRule("a calibration of a serial arm", "catseye-serial-arm/1")


def calibrated(bench: SerialBench, result: Mapping[str, Any]) -> "Geometry":
    """Return the arm with the parameters of a result, and with the masses that they were identified with.

    Raises:
        PlanError: the result is none of an arm with these joints and targets.
    """
    # The solver takes its time to import: whoever lists procedures does without.
    from catseye.calibration.core.errors import CalibrationError
    from catseye.calibration.serial_arm.arm import SerialArm, Target
    from catseye.calibration.serial_arm.named_values import geometry_of

    targets = tuple(Target(one.name, one.place_mm) for one in bench.targets)
    try:
        arm = SerialArm(bench.workspace.chain, _loads(bench, result), targets)
        return geometry_of(arm, _values(bench, result))
    except CalibrationError as error:
        raise PlanError(f"result: {error}") from error


def identified_target(bench: SerialBench, geometry: "Geometry", name: str) -> ToolTarget:
    """Return a target of the tool where it was identified on the flange.

    Raises:
        PlanError: the tool has no such target.
    """
    target = bench.target(name)
    x, y, z = geometry.tools[bench.targets.index(target), :3, 3].tolist()
    return replace(target, place_mm=(x, y, z))


def _loads(bench: SerialBench, result: Mapping[str, Any]) -> tuple[Load, ...]:
    """Return the masses of links and tool as the result has them, the cell's where a result of others has none.

    Raises:
        PlanError: they cannot be read.
    """
    chain, described, tool = bench.workspace.chain, result.get("description"), result.get("tool")
    try:
        links = (
            bench.loads[:-1]
            if described is None
            else tuple(
                _load(number if link.get("joint") is None else chain.frame_of(link["joint"]), link)
                for number, link in enumerate(described.get("link", ()), 1)
            )
        )
        if "tool" not in result:
            return (*links, *bench.loads[-1:])
        return links if tool is None else (*links, _load(len(bench.arm.axes), tool))
    except (AttributeError, KeyError, TypeError, ValueError, KinematicsError) as error:
        raise PlanError(
            f"result: its masses cannot be read ({error}); create it again with catseye calibrate"
        ) from error


def _load(frame: int, part: Mapping[str, Any]) -> Load:
    x, y, z = map(float, part["centre_mm"])
    return Load(frame, float(part["mass_kg"]), (x, y, z))


def _values(bench: SerialBench, result: Mapping[str, Any]) -> dict[str, float]:
    """Return the parameters of a result by name, those of distances left out.

    Raises:
        PlanError: it is none of an arm with these joints.
    """
    try:
        parts = [part for part in result["parameters"] if not part.get("of_distances", False)]
        values = {str(part["name"]): float(part["value"]) for part in parts}
    except (KeyError, TypeError, ValueError) as error:
        raise PlanError(
            f"result: its parameters cannot be read ({error}); create it again with catseye calibrate"
        ) from error
    if len(values) < len(parts):
        raise PlanError(
            "result: a parameter stands twice in it: the file is damaged; create it again with catseye calibrate"
        )
    joints = [axis.name for axis in bench.arm.axes]
    identified = {name.rpartition(".")[0] for name in values}
    if not identified & set(joints):
        raise PlanError(
            f"result: it has no parameter of {', '.join(joints)}: a ballbar is led by commands of a "
            "calibrated arm only; "
            "calibrate with a geometric model"
        )
    return values

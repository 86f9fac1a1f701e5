"""A result turned back into an arm that says where its targets are, with uncertainties."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.app.cell.arm import ArmDescription, arm_description
from catseye.app.errors import UsageError
from catseye.app.results.serial_arm.nominal_arm import serial_arm_of, with_flange, with_unknown_targets
from catseye.app.results.serial_arm.result import ParameterPart, SerialArmResult
from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.serial_arm.absolute import base_rates
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.compensation import Compensated, compensate
from catseye.calibration.serial_arm.geometry import Commands, Geometry
from catseye.calibration.serial_arm.joint_source import JointSource, require_commanded
from catseye.calibration.serial_arm.named_values import geometry_of
from catseye.calibration.serial_arm.parameters import FRAME_PARTS, BaseFrame, MapNode, Reversal, TargetPlace

_DEAD_PATH: Final = ".dead_path_mm"
_PLACE: Final = ("x_mm", "y_mm", "z_mm")


@dataclass(frozen=True)
class IdentifiedArm:
    """An arm as a result has it.

    Attributes:
        geometry: with the values of the result.
        covariance: of the identified parameters, the base's as steps from where it is, shape (p, p).
        identified: numbers of the identified ones among the parameters of the geometry.
        distances: places of anchors and dead paths.
        left_mm: standard deviation of each coordinate by which the model misses a single pose.
        joints: that the result was identified with.
    """

    geometry: Geometry
    covariance: Floats
    identified: tuple[int, ...]
    distances: "IdentifiedDistances"
    left_mm: float = 0.0
    joints: JointSource = "commanded"

    @property
    def arm(self) -> SerialArm:
        """The nominal arm with the targets of the result."""
        return self.geometry.arm

    @property
    def reverses(self) -> bool:
        """The result has backlash: where the arm stands depends on the sides that its joints come from."""
        roles = [one.role for one in self.geometry.parameters]
        return any(
            isinstance(role, Reversal) or (isinstance(role, MapNode) and role.reversal) for role in roles
        )

    @property
    def with_distances(self) -> Floats:
        """Covariance of the identified parameters and of what is known of distances, in this order."""
        known = self.distances
        return np.block([[self.covariance, known.cross], [known.cross.T, known.own]])

    @property
    def target_names(self) -> tuple[str, ...]:
        """Names of the targets of the tool, and of the flange."""
        return tuple(one.name for one in self.arm.targets)

    def number_of(self, target: str) -> int:
        """Return the number of a target.

        Raises:
            UsageError: there is none of this name.
        """
        names = self.target_names
        if target not in names:
            raise UsageError(f"the calibrated arm has no target {target!r}; it has {', '.join(names)}")
        return names.index(target)

    def compensated(self, poses: Floats, target: str | None, approach: Floats | None = None) -> Compensated:
        """Return the commands that bring a target, where it was identified on the flange, to poses of a program.

        Args:
            poses: joints of the nominal arm, deg or mm, shape (n, joints).
            target: its name; the flange without one.
            approach: side that each joint comes from, shape (n, joints); see `compensate`.

        Raises:
            UsageError: there is no such target, or the joints of the result were read back.
        """
        try:
            require_commanded(self.joints)
        except ArgumentError as error:
            raise UsageError(str(error)) from error
        tool = None if target is None else self.geometry.tools[self.number_of(target)]
        return compensate(self.geometry, poses, tool, approach)

    def places_mm(self, commands: Commands, target: int) -> tuple[Floats, Floats]:
        """Return where a target is at poses, in the frame of the instrument, mm, (n, 3), and the covariance, mm²."""
        places, steps = self.moved_mm(commands, target)
        known = steps @ self.covariance @ steps.transpose(0, 2, 1)
        return places, np.asarray(known + self.left_mm**2 * np.eye(3))

    def moved_mm(self, commands: Commands, target: int) -> tuple[Floats, Floats]:
        """Return where a target is, mm, (n, 3), and how the identified parameters move it, shape (n, 3, p)."""
        geometry = self.geometry
        frames = geometry.frames(commands)
        places = geometry.places_mm(frames[-1], np.full(len(commands), target))
        moved = geometry.motions(commands, frames, len(geometry.parameters)).of_points(places)
        for k, parameter in enumerate(geometry.parameters):
            match parameter.role:
                case TargetPlace(number, "x_mm" | "y_mm" | "z_mm" as part) if number == target:
                    moved[:, :, k] = frames[-1, :, :3, "xyz".index(part[0])]
        return places, moved[:, :, list(self.identified)]


@dataclass(frozen=True)
class IdentifiedDistances:
    """What a result knows of distances.

    Attributes:
        anchors: places, mm, by name.
        dead_paths: mm, by anchor and segment.
        names: of the identified numbers among them.
        cross: covariance with the identified parameters of the arm, shape (p, names).
        own: covariance among themselves, shape (names, names).
    """

    anchors: Mapping[str, Floats]
    dead_paths: Mapping[str, float]
    names: tuple[str, ...]
    cross: Floats
    own: Floats

    def moved(self, anchor: str, path: str, towards: Floats) -> Floats:
        """Return how a distance changes with the identified numbers among them, shape (names,).

        Args:
            anchor: name of its fixed end; empty where that is not the result's.
            path: name of its dead path; empty where it has none.
            towards: unit vector from the anchor to the target, shape (3,).
        """
        return np.array([_slope(name, anchor, path, towards) for name in self.names])


def _slope(name: str, anchor: str, path: str, towards: Floats) -> float:
    owner, _, part = name.rpartition(".")
    if anchor and owner == anchor and part in _PLACE:
        return -float(towards["xyz".index(part[0])])
    return -1.0 if path and owner == path else 0.0


def identified_arm(result: SerialArmResult) -> IdentifiedArm:
    """Return the arm of a result.

    Raises:
        UsageError: the result has a parameter that its arm does not have.
        ConfigError: the result has no description of its arm, and there is none of that name.
    """
    parts = [part for part in result.parameters if not part.of_distances]
    geometry = _geometry(_nominal(result), parts)
    identified = tuple(k for k, part in enumerate(parts) if part.identified)
    estimated = [part for part in result.parameters if part.identified]
    of_arm = np.array([not part.of_distances for part in estimated], dtype=np.bool_)
    every = _covariance(result, geometry, identified, of_arm)
    return IdentifiedArm(
        geometry,
        every[of_arm][:, of_arm],
        identified,
        IdentifiedDistances(
            {one.name: np.array(one.place_mm) for one in result.anchors},
            _dead_paths(result.parameters),
            tuple(part.name for part in estimated if part.of_distances),
            every[of_arm][:, ~of_arm],
            every[~of_arm][:, ~of_arm],
        ),
        result.left_mm or 0.0,
        result.joints,
    )


def arm_with_frames(result: SerialArmResult) -> Geometry | None:
    """Return the arm as drawn, with base and targets fitted; None where the result does not have it.

    Raises:
        UsageError: as for `identified_arm`.
        ConfigError: as for `identified_arm`.
    """
    if result.frames is None:
        return None
    parts = [part for part in result.frames.parameters if not part.of_distances]
    return _geometry(_nominal(result), parts)


def ends_with_frames(result: SerialArmResult) -> tuple[dict[str, Floats], dict[str, float]]:
    """Return anchors, mm, and dead paths, mm, as they were fitted with the links as drawn; by name."""
    parts = [] if result.frames is None else result.frames.parameters
    places = {one.name: np.array(one.place_mm) for one in result.anchors}
    for one in parts:
        owner, _, part = one.name.rpartition(".")
        if one.of_distances and owner in places and part in _PLACE:
            places[owner]["xyz".index(part[0])] = one.value
    return places, _dead_paths(parts)


def _dead_paths(parts: Sequence[ParameterPart]) -> dict[str, float]:
    """Return dead paths, mm, by anchor and segment."""
    return {one.name.removesuffix(_DEAD_PATH): one.value for one in parts if one.name.endswith(_DEAD_PATH)}


def _geometry(arm: SerialArm, parts: Sequence[ParameterPart]) -> Geometry:
    try:
        return geometry_of(arm, {part.name: part.value for part in parts})
    except ArgumentError as error:
        raise UsageError(str(error)) from error


def _nominal(result: SerialArmResult) -> SerialArm:
    description: ArmDescription = result.description or arm_description(result.arm)
    arm = serial_arm_of(description, result.tool)
    if arm.targets:
        return with_flange(arm)
    named = dict.fromkeys(
        part.name.rpartition(".")[0]
        for part in result.parameters
        if part.name.rpartition(".")[2] in FRAME_PARTS and not part.of_distances
    )
    return with_flange(with_unknown_targets(arm, [name for name in named if name != "base"]))


def _covariance(
    result: SerialArmResult, geometry: Geometry, identified: tuple[int, ...], of_arm: Bools
) -> Floats:
    """Return the covariance of all identified parameters, the base's turned into steps from where it is."""
    u = np.array([part.u for part in result.parameters if part.identified])
    covariance = np.array(result.correlation).reshape(len(u), len(u)) * np.outer(u, u)
    turned, steps = np.eye(len(u)), np.linalg.pinv(base_rates(geometry))
    rows = {
        int(place): FRAME_PARTS.index(role.part)
        for place, k in zip(np.flatnonzero(of_arm), identified, strict=True)
        if isinstance(role := geometry.parameters[k].role, BaseFrame)
    }
    for place, row in rows.items():
        for other, column in rows.items():
            turned[place, other] = steps[row, column]
    return np.asarray(turned @ covariance @ turned.T)

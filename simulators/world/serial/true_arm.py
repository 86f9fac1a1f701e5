"""A true serial arm: what its drawing does not say, drawn from the seed, or read from `catseye-serial-arm/1`.

Documents name numbers as results of calibrations do: `base.x_mm`, `J2.alpha_deg`, `J2.compliance_rad_per_nmm`,
`J2.reversal_deg`, `J2.cos2_deg`, `nest1.x_mm`. Uncertainties and what else results carry are left alone.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from catseye.simulators.config import EmulationConfig, SerialArm, SerialJoint, SerialLoad, TruthText
from catseye.simulators.errors import TruthFileError
from catseye.simulators.survey import Mark, Place
from catseye.simulators.world.serial.frames import frames_of
from catseye.simulators.world.serial.table_seven import (
    BASE,
    COMPLIANCES_RAD_PER_NMM,
    LOADS,
    identified_parts,
    is_irb120,
)
from catseye.simulators.world.serial.truth import (
    FORMAT as DRIVETRAINS_FORMAT,
)
from catseye.simulators.world.serial.truth import (
    ArmTruth,
    JointTruth,
    Wave,
    draw_joint_truth,
    read_joint_truth,
)
from catseye.simulators.world.types import Floats

FORMAT: Final = "catseye-serial-arm/1"

PAPER_SEED: Final = 2
"""Seed with which an IRB 120 is that of the paper: the one that `catseye emulate` takes by default."""

_LINK_PARTS = ("alpha_deg", "beta_deg", "a_mm", "theta_offset_deg", "d_mm")
_FRAME_PARTS = ("x_mm", "y_mm", "z_mm", "rx_deg", "ry_deg", "rz_deg")
_PLACE_PARTS = _FRAME_PARTS[:3]
_WAVE = re.compile(r"(cos|sin)(\d+(?:\.\d+)?)_deg")

_SPREADS: Final = {
    "alpha_deg": 0.017,
    "beta_deg": 0.017,
    "a_mm": 0.14,
    "theta_offset_deg": 0.07,
    "d_mm": 0.12,
}
"""Rms of what Table VII is off Table II; lengths of an arm of one metre."""

_BASE_SPREADS: Final = (0.1, 0.1, 0.1, 0.02, 0.02, 0.02)
"""Of Table VI, mm and deg."""

_MASS_SPREAD = 0.05
"""Standard deviation of a true mass from its description, as a part of it; an assumption."""

_METRE_MM = 1000.0
_RIGID_NM_PER_DEG = 1e9
_NMM_PER_NM = 1e3

_NEAR_MM, _NEAR_DEG = 50.0, 5.0
"""A base farther off than that is in an instrument's frame, not in the room's."""


@dataclass(frozen=True)
class TrueArm:
    """An arm as it really is.

    Attributes:
        drawn: as its description has it.
        arm: with true geometry and masses.
        base_parts: x, y, z in mm and angles about x, y, z in deg of its base in the room.
        drives: its drivetrains.
        targets: nests on its tool where they really are.
    """

    drawn: SerialArm
    arm: SerialArm
    base_parts: tuple[float, ...]
    drives: ArmTruth
    targets: tuple[Mark, ...]

    @property
    def base(self) -> Floats:
        """Its base in the room, shape (4, 4)."""
        parts = np.array(self.base_parts)
        return frames_of(parts[:3], np.deg2rad(parts[3:]))

    def document(self) -> dict[str, object]:
        """Return what `read_true_arm` takes, ready for `json.dump`."""
        return {
            "format": FORMAT,
            "arm": self.drawn.name,
            "model": "the bench's truth",
            "parameters": [*self._base(), *self._joints(), *self._targets()],
            "loads": [
                {"frame": load.frame, "mass_kg": load.mass_kg, "centre_mm": list(load.centre_mm)}
                for load in self.arm.loads
            ],
            "drivetrains": [joint.model_dump(mode="json") for joint in self.drives.joints],
        }

    def _base(self) -> list[dict[str, object]]:
        values = zip(_FRAME_PARTS, self.base_parts, strict=True)
        return [_parameter(f"base.{part}", value, 0.0) for part, value in values]

    def _joints(self) -> list[dict[str, object]]:
        found: list[dict[str, object]] = []
        for drawn, joint, drive in zip(self.drawn.joints, self.arm.joints, self.drives.joints, strict=True):
            name = joint.name
            found += [_parameter(f"{name}.{p}", getattr(joint, p), getattr(drawn, p)) for p in _LINK_PARTS]
            if not joint.prismatic:
                compliance = np.deg2rad(1.0 / drive.stiffness_nm_per_deg) / _NMM_PER_NM
                found.append(_parameter(f"{name}.compliance_rad_per_nmm", float(compliance), 0.0))
            for wave in drive.waves:
                found.append(_parameter(f"{name}.cos{wave.order:g}_deg", wave.cos_deg, 0.0))
                found.append(_parameter(f"{name}.sin{wave.order:g}_deg", wave.sin_deg, 0.0))
        return found

    def _targets(self) -> list[dict[str, object]]:
        return [
            _parameter(f"{target.name}.{part}", value, None)
            for target in self.targets
            for part, value in zip(_PLACE_PARTS, target.place_mm, strict=True)
        ]


def true_serial_arm(arm: SerialArm, config: EmulationConfig) -> TrueArm:
    """Return the true arm of a configuration: of its document, or drawn from its seed.

    Raises:
        TruthFileError: the document does not fit, or nothing can be drawn of such an arm.
    """
    if config.truth is None:
        return draw_true_arm(arm, config)
    if DRIVETRAINS_FORMAT.encode() in config.truth.raw:
        drives = read_joint_truth(config.truth, arm)
        return TrueArm(arm, arm, (0.0,) * 6, drives, config.survey.targets)
    return read_true_arm(config.truth, arm, config)


def draw_true_arm(arm: SerialArm, config: EmulationConfig) -> TrueArm:
    """Draw a plausible arm: the same seed gives the same one, and `PAPER_SEED` the IRB 120 of the paper.

    Raises:
        TruthFileError: nobody knows what drivetrains such an arm has.
    """
    drives = draw_joint_truth(arm, config.seed)
    targets = _made(config)
    if any(joint.prismatic for joint in arm.joints):
        return TrueArm(arm, arm, (0.0,) * 6, drives, targets)
    if is_irb120(arm) and config.seed == PAPER_SEED:
        return _of_the_paper(arm, drives, targets)
    rng = np.random.default_rng([config.seed, 42])
    joints = [arm.joints[0], *(_off(joint, _reach_m(arm), rng) for joint in arm.joints[1:])]
    factors = 1.0 + _MASS_SPREAD * rng.standard_normal(len(arm.loads))
    loads = tuple(
        replace(load, mass_kg=load.mass_kg * factor)
        for load, factor in zip(arm.loads, factors.tolist(), strict=True)
    )
    base = tuple(rng.normal(0.0, _BASE_SPREADS).tolist())
    return TrueArm(arm, replace(arm, joints=tuple(joints), loads=loads), base, drives, targets)


class _Document(BaseModel):
    model_config = ConfigDict(strict=True, frozen=True, extra="ignore", allow_inf_nan=False)


class _Parameter(_Document):
    name: str
    value: float
    of_distances: bool = False


class _Load(_Document):
    frame: int = Field(ge=0)
    mass_kg: float = Field(ge=0.0)
    centre_mm: Place = Field(strict=False)


class _Truth(_Document):
    format: Literal["catseye-serial-arm/1"]
    parameters: list[_Parameter]
    loads: list[_Load] | None = None
    drivetrains: list[JointTruth] | None = None


def read_true_arm(text: TruthText, arm: SerialArm, config: EmulationConfig) -> TrueArm:
    """Read a true arm; what its parameters do not name is as drawn, and joints without a compliance are rigid.

    Raises:
        TruthFileError: the document does not fit; the text names file and key.
    """
    try:
        document = _Truth.model_validate_json(text.raw)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"]) or "(document)"
        raise TruthFileError(f"{text.source}: {key}: {first['msg']}") from error
    values = {one.name: one.value for one in document.parameters if not one.of_distances}
    reading = _Reading(values, text.source)
    joints = tuple(reading.joint(joint) for joint in arm.joints)
    drives = document.drivetrains or [
        reading.drive(drive) for drive in draw_joint_truth(arm, config.seed).joints
    ]
    if [drive.name for drive in drives] != [joint.name for joint in joints]:
        names = ", ".join(drive.name for drive in drives)
        raise TruthFileError(
            f"{text.source}: drivetrains: it has those of {names}; {arm.name} has other joints"
        )
    loads = arm.loads
    if document.loads is not None:
        loads = tuple(SerialLoad(load.frame, load.mass_kg, load.centre_mm) for load in document.loads)
    targets = tuple(reading.target(target) for target in _made(config))
    base = reading.base()
    reading.require_all_taken(bool(document.drivetrains))
    true = replace(arm, joints=joints, loads=loads)
    return TrueArm(arm, true, base, ArmTruth(format=DRIVETRAINS_FORMAT, joints=tuple(drives)), targets)


class _Reading:
    """Takes numbers by their names."""

    def __init__(self, values: Mapping[str, float], source: str) -> None:
        self._values = dict(values)
        self._source = source
        self._taken: set[str] = set()

    def base(self) -> tuple[float, ...]:
        """Return the base; one that is far off stands in an instrument's frame, and is left where it is drawn."""
        parts = tuple(self._take(f"base.{part}", 0.0) for part in _FRAME_PARTS)
        near = max(map(abs, parts[:3])) <= _NEAR_MM and max(map(abs, parts[3:])) <= _NEAR_DEG
        return parts if near else (0.0,) * 6

    def joint(self, joint: SerialJoint) -> SerialJoint:
        """Return a joint with what is named of it."""
        parts: dict[str, Any] = {
            part: self._take(f"{joint.name}.{part}", getattr(joint, part)) for part in _LINK_PARTS
        }
        return replace(joint, **parts)

    def drive(self, drive: JointTruth) -> JointTruth:
        """Return a drivetrain with what is named of it."""
        compliance = self._take(f"{drive.name}.compliance_rad_per_nmm", 0.0)
        if compliance < 0.0:
            raise TruthFileError(f"{self._source}: {drive.name}.compliance_rad_per_nmm: it is below 0")
        softness = float(np.rad2deg(compliance)) * _NMM_PER_NM
        stiffness = 1.0 / softness if softness > 1.0 / _RIGID_NM_PER_DEG else _RIGID_NM_PER_DEG
        changes: dict[str, object] = {"stiffness_nm_per_deg": stiffness, "waves": self._waves(drive.name)}
        if f"{drive.name}.reversal_deg" in self._values:
            changes |= {"reversal_deg": self._take(f"{drive.name}.reversal_deg", 0.0), "play_deg": 0.0}
        return drive.model_copy(update=changes)

    def target(self, target: Mark) -> Mark:
        """Return a nest with what is named of it; a nest has no orientation, whatever a result says of its frame."""
        for part in _FRAME_PARTS[3:]:
            self._take(f"{target.name}.{part}", 0.0)
        x, y, z = (
            self._take(f"{target.name}.{part}", value)
            for part, value in zip(_PLACE_PARTS, target.place_mm, strict=True)
        )
        return replace(target, place_mm=(x, y, z))

    def require_all_taken(self, drives_given: bool) -> None:
        """Raise TruthFileError if something is named that the bench has not."""
        left = sorted(
            name for name in self._values.keys() - self._taken if not (drives_given and _of_drive(name))
        )
        if left:
            raise TruthFileError(f"{self._source}: parameters: the bench has no {left[0]}")

    def _waves(self, joint: str) -> tuple[Wave, ...]:
        orders: dict[float, dict[str, float]] = {}
        for name in self._values:
            found = _WAVE.fullmatch(name.removeprefix(f"{joint}."))
            if name.startswith(f"{joint}.") and found:
                orders.setdefault(float(found[2]), {})[f"{found[1]}_deg"] = self._take(name, 0.0)
        return tuple(Wave(order=order, **amplitudes) for order, amplitudes in orders.items())

    def _take(self, name: str, otherwise: float) -> float:
        self._taken.add(name)
        return self._values.get(name, otherwise)


def _of_drive(name: str) -> bool:
    part = name.rpartition(".")[2]
    return part in {"compliance_rad_per_nmm", "reversal_deg"} or bool(_WAVE.fullmatch(part))


def _of_the_paper(arm: SerialArm, drives: ArmTruth, targets: tuple[Mark, ...]) -> TrueArm:
    parts: Sequence[dict[str, Any]] = identified_parts()
    joints = tuple(replace(joint, **its) for joint, its in zip(arm.joints, parts, strict=True))
    tool = tuple(load for load in arm.loads if load.frame == len(arm.joints))
    stiff = [
        drive
        if not compliance
        else drive.model_copy(
            update={"stiffness_nm_per_deg": 1.0 / (float(np.rad2deg(compliance)) * _NMM_PER_NM)}
        )
        for drive, compliance in zip(drives.joints, COMPLIANCES_RAD_PER_NMM, strict=True)
    ]
    true = replace(arm, joints=joints, loads=(*LOADS, *tool))
    elastic = ArmTruth(format=DRIVETRAINS_FORMAT, joints=tuple(stiff))
    return TrueArm(arm, true, tuple(BASE[part] for part in _FRAME_PARTS), elastic, targets)


def _off(joint: SerialJoint, reach_m: float, rng: np.random.Generator) -> SerialJoint:
    """Return a joint that is off its drawing; only an axis parallel to the one before tilts both ways."""
    changes: dict[str, Any] = {}
    parallel = abs(np.sin(np.deg2rad(joint.alpha_deg))) < 1e-9
    for part, spread in _SPREADS.items():
        size = spread * (reach_m if part.endswith("_mm") else 1.0)
        off = float(rng.normal(0.0, size))
        if part != "beta_deg" or parallel:
            changes[part] = getattr(joint, part) + off
    return replace(joint, **changes)


def _reach_m(arm: SerialArm) -> float:
    return sum(abs(joint.a_mm) + abs(joint.d_mm) for joint in arm.joints) / _METRE_MM


def _made(config: EmulationConfig) -> tuple[Mark, ...]:
    """Return the nests of the tool where somebody really made them."""
    rng = np.random.default_rng([config.seed, 43])
    found = []
    for target in config.survey.targets:
        x, y, z = (np.array(target.place_mm) + rng.normal(0.0, config.survey.u_target_mm, 3)).tolist()
        found.append(replace(target, place_mm=(x, y, z)))
    return tuple(found)


def _parameter(name: str, value: float, nominal: float | None) -> dict[str, object]:
    unit = "rad/(N·mm)" if name.endswith("_rad_per_nmm") else "mm" if name.endswith("_mm") else "deg"
    return {"name": name, "value": value, "u": 0.0, "unit": unit, "nominal": nominal, "identified": True}

"""What the procedures of serial arms keep."""

from dataclasses import dataclass
from typing import ClassVar, Final

from catseye.drivers.roles.tracker import Place, TargetPoint, TargetPose
from catseye.procedures.kit.records import Json, Record

PLANNED: Final = "poses-planned"
"""Event with the names and joints of all poses of a run, in their order."""

VISITS: Final = ("pose", "again")
"""How the ids of steps begin that measure targets at a pose, before a slash and its number among those planned."""


@dataclass(frozen=True, kw_only=True)
class MeasuredTarget(Record):
    """A target at a pose, in the instrument's frame. `extra` has the joints: commanded `q`, read back `q_read`.

    Attributes:
        pose: name of the pose.
        target: its name; of an optical CMM that of the frame.
        x_mm: of the target, or of the frame's origin.
        y_mm: likewise.
        z_mm: likewise.
        u_x_mm: standard uncertainty as the instrument states it; None where it says nothing.
        u_y_mm: likewise.
        u_z_mm: likewise.
        cov_xy_mm2: covariance as the instrument states it; None where it states none, which does not mean zero.
        cov_xz_mm2: likewise.
        cov_yz_mm2: likewise.
        rx_deg: of a frame, R = Rz · Ry · Rx; None of a point.
        ry_deg: likewise.
        rz_deg: likewise.
        u_deg: standard uncertainty of the rotations, their largest.
        visible: marks of the frame that were seen; None where the instrument does not say.
        base_visible: likewise of the marks on the base.
        nests_round: number of the last measurement of the fixed nests, from 0; None without any.
    """

    table: ClassVar[str] = "targets"
    is_point: ClassVar[bool] = True
    point_name: ClassVar[str] = "target"
    target_column: ClassVar[str] = "target"
    pose: str
    target: str
    x_mm: float
    y_mm: float
    z_mm: float
    u_x_mm: float | None = None
    u_y_mm: float | None = None
    u_z_mm: float | None = None
    cov_xy_mm2: float | None = None
    cov_xz_mm2: float | None = None
    cov_yz_mm2: float | None = None
    rx_deg: float | None = None
    ry_deg: float | None = None
    rz_deg: float | None = None
    u_deg: float | None = None
    visible: int | None = None
    base_visible: int | None = None
    nests_round: int | None = None


@dataclass(frozen=True, kw_only=True)
class MeasuredNest(Record):
    """A nest that stays where it is, in the instrument's frame.

    Attributes:
        nest: its name.
        nests_round: number of the measurement of all nests, from 0.
        face: of the tracker.
    """

    table: ClassVar[str] = "nests"
    nest: str
    nests_round: int
    face: int = 1
    x_mm: float
    y_mm: float
    z_mm: float
    u_x_mm: float | None = None
    u_y_mm: float | None = None
    u_z_mm: float | None = None
    cov_xy_mm2: float | None = None
    cov_xz_mm2: float | None = None
    cov_yz_mm2: float | None = None


Values = dict[str, float | None]


def coordinates(place_mm: Place, u_mm: Place | None) -> Values:
    """Return place and uncertainty by the names of their columns."""
    named: Values = dict(zip(("x_mm", "y_mm", "z_mm"), place_mm, strict=True))
    stated: tuple[float | None, ...] = u_mm or (None, None, None)
    return named | dict(zip(("u_x_mm", "u_y_mm", "u_z_mm"), stated, strict=True))


def covariances(covariance_mm2: Place | None) -> Values:
    """Return covariances of x with y, x with z and y with z by the names of their columns; None: none is stated."""
    stated: tuple[float | None, ...] = covariance_mm2 or (None, None, None)
    return dict(zip(("cov_xy_mm2", "cov_xz_mm2", "cov_yz_mm2"), stated, strict=True))


def target_record(
    pose: str,
    target: str,
    found: TargetPoint | TargetPose,
    joints: tuple[tuple[float, ...], tuple[float, ...]],
    nests_round: int | None,
) -> MeasuredTarget:
    """Return a measured target as it is kept.

    Args:
        joints: commanded and read back.
    """
    extra: dict[str, Json] = {"q": list(joints[0]), "q_read": list(joints[1])}
    more: Values = {}
    visible = base_visible = None
    if isinstance(found, TargetPose):
        more = dict(zip(("rx_deg", "ry_deg", "rz_deg"), found.turn_deg, strict=True))
        more["u_deg"] = None if found.u_deg is None else max(found.u_deg)
        visible, base_visible = found.visible, found.base_visible
    else:
        more = covariances(found.covariance_mm2)
    values = coordinates(found.place_mm, found.u_mm) | more
    return MeasuredTarget(
        pose=pose,
        target=target,
        visible=visible,
        base_visible=base_visible,
        nests_round=nests_round,
        extra=extra,
        **values,  # type: ignore[arg-type]  # the keys are those of coordinates, which always has the three places
    )

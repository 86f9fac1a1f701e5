"""Error maps as compensation value lists of CNC kernels: bilateral leadscrew error compensation, `kw.ssfk`.

The form is that of the manuals of TwinCAT CNC (TF5200) and of the ISG kernel: one list an axis, values between the
interpolation points are linear as they are in the map, so every node becomes an interpolation point with its two
values, actual minus command. Units for rotary axes are 0.0001°.
"""

from collections.abc import Iterator

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.results.scara.compensated_path import Origin
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.error_map import BidirectionalMap
from catseye.calibration.scara.identification import IdentifiedArm

_PER_DEG = 10_000
"""Units of a rotary axis in a degree."""

_MOST_POINTS = 1499
"""The number of entries has to be below P-COMP-00059, which is 1500 unless configured."""

_NOTES = (
    "values: actual minus command in 0.0001 deg, at interpolation points in 0.0001 deg; pos where the axis moves to "
    "larger angles, neg to smaller ones",
    "outside of the points the controller goes on with the value at the end: keep the axis inside of them",
    "kopf.achs_nr and kopf.log_achs_name are those of an axis list in which the joints come first: adapt them",
    "the list acts after lr_param.ssfk is 1 in the axis' machine data (P-AXIS-00175)",
    "turn the controller's own backlash compensation of this axis off: the reversal error is in the table",
    "check the sign at one node: with the table the measured deviation has to vanish, not to double",
)


def maps_of(arm: IdentifiedArm) -> tuple[BidirectionalMap, BidirectionalMap]:
    """Return the maps that tables of single axes hold.

    Raises:
        UsageError: the result has no maps, or terms that such tables cannot hold.
    """
    layout = arm.layout
    if layout.model == "conventional":
        raise UsageError(
            "a conventional result holds no maps, and θ20 is one offset of J2's zero: put it and the identified "
            "links into the controller's kinematics, or identify with --model error-map"
        )
    angular = [term.name for term in layout.terms if term.target in {"theta1", "theta2"}]
    if angular:
        raise UsageError(
            f"a table of a single axis cannot hold {', '.join(angular)}, which the maps of this result leave to it: "
            "identify without --extend for a table, or compensate commands (--format csv, json or melfa)"
        )
    return _map(arm, layout.nodes1_rad, layout.map1), _map(arm, layout.nodes2_rad, layout.map2)


def ssfk_table(joint: int, table: BidirectionalMap, origin: Origin) -> str:
    """Return the compensation value list of a joint.

    Args:
        joint: 1 or 2.
        origin: of the map, for the comments.

    Raises:
        UsageError: the map has more nodes than a list takes, or two of them become one in its units.
    """
    points = _units(table.nodes_rad)
    if points.size > _MOST_POINTS or np.any(np.diff(points) <= 0):
        raise UsageError(
            f"the map of J{joint} has {points.size} nodes; a list takes {_MOST_POINTS}, at least 0.0001° apart: "
            "identify with fewer nodes"
        )
    columns = {"setpoint": points, "pos": _units(table.positive_rad), "neg": _units(table.negative_rad)}
    lines = [f"# {text}" for text in _head(joint, origin)]
    lines += [
        _entry("kopf.achs_nr", joint),
        _entry("kopf.log_achs_name", f"J{joint}"),
        _entry("kw.ssfk.interval", 0),
        _entry("kw.ssfk.kw_startpos", int(points[0])),
        _entry("kw.ssfk.kw_nr_max", points.size),
        _entry("kw.ssfk.unit", 1),
        _entry("kw.ssfk.bilateral", 1),
        _entry("kw.ssfk.modulo", 0),
    ]
    lines += [
        _entry(f"kw.ssfk.table[{i}].{name}", int(value))
        for name, values in columns.items()
        for i, value in enumerate(values)
    ]
    return "\n".join(lines) + "\n"


def _head(joint: int, origin: Origin) -> Iterator[str]:
    yield f"compensation value list of J{joint}: bilateral, one interpolation point a node of its error map"
    yield from origin.sentences()
    yield (
        "links are not part of a table of single axes: give the controller's kinematics "
        f"{origin.links_mm[0]:.4f} and {origin.links_mm[1]:.4f} mm"
    )
    yield from _NOTES


def _entry(name: str, value: object) -> str:
    return f"{name:<36}{value}"


def _units(angle_rad: Floats) -> Floats:
    return np.asarray(np.round(np.rad2deg(angle_rad) * _PER_DEG), dtype=np.float64)


def _map(arm: IdentifiedArm, nodes_rad: Floats, part: slice) -> BidirectionalMap:
    values = arm.parameters[part]
    return BidirectionalMap(nodes_rad, values[: nodes_rad.size], values[nodes_rad.size :])

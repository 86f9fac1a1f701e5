"""Every parameter of a result, one a row."""

from collections.abc import Collection
from dataclasses import dataclass
from typing import Final, Literal

from catseye.app.results.model import Column, Quantity, Table
from catseye.app.results.numbers import OF_UNIT, fixed
from catseye.app.results.scara.identified_arm import nominal_of
from catseye.app.results.scara.names import node_name
from catseye.app.results.scara.result import Estimate, MapTable, Result
from catseye.calibration.scara.extension import Term

Unit = Literal["mm", "mdeg", "µm"]
Kind = Literal["arm", "map", "reflector", "dead path"]
KINDS: Final[tuple[Kind, ...]] = ("arm", "map", "reflector", "dead path")


@dataclass(frozen=True)
class ResultValue:
    """One parameter.

    Attributes:
        kind: what it belongs to.
        quantity: its name, without the node.
        unit: of all figures.
        value: estimate.
        u: standard uncertainty.
        nominal: value before the identification, None where there is none.
        joint: of a map, else 0.
        node_deg: of a map.
        direction: of a map: 1 or -1.
    """

    kind: Kind
    quantity: str
    unit: Unit
    value: float
    u: float
    nominal: float | None = None
    joint: int = 0
    node_deg: float | None = None
    direction: int | None = None

    @property
    def name(self) -> str:
        """Name with the node."""
        if self.node_deg is None or self.direction is None:
            return self.quantity
        return node_name(self.joint, self.node_deg, self.direction)


def result_values(result: Result) -> list[ResultValue]:
    """Return every parameter: links, offset, maps, further terms, reflectors, dead paths."""
    nominal = nominal_of(result)[0]
    values = [
        _value("arm", "L1", "mm", result.link1_mm, nominal[0]),
        _value("arm", "L2", "mm", result.link2_mm, nominal[1]),
    ]
    for name, estimate in (("L1 at 20 °C", result.link1_20c_mm), ("L2 at 20 °C", result.link2_20c_mm)):
        values += [] if estimate is None else [_value("arm", name, "mm", estimate)]
    if result.theta20_mdeg is not None:
        values.append(_value("arm", "θ20", "mdeg", result.theta20_mdeg, 0.0))
    for joint, table in ((1, result.theta1_map), (2, result.theta2_map)):
        values += [] if table is None else _map_values(joint, table)
    for one in result.extension or []:
        term = Term(one.target, one.source, one.part, one.order)
        unit: Unit = "µm" if one.unit == "um" else "mdeg"
        values.append(_value("arm", term.name, unit, Estimate(value=one.value, u=one.u), 0.0))
    for place in result.reflectors:
        values.append(_value("reflector", f"{place.name}.x", "mm", place.x_mm))
        values.append(_value("reflector", f"{place.name}.y", "mm", place.y_mm))
    return values + [
        _value("dead path", f"dead path {dead.reflector}/{dead.segment}", "mm", dead.length_mm)
        for dead in result.dead_paths
    ]


def largest_map_u_mdeg(result: Result) -> float | None:
    """Return the largest standard uncertainty of a map's node, mdeg; None without maps."""
    return max((value.u for value in result_values(result) if value.kind == "map"), default=None)


def _value(
    kind: Kind, name: str, unit: Unit, estimate: Estimate, nominal: float | None = None
) -> ResultValue:
    return ResultValue(kind, name, unit, estimate.value, estimate.u, nominal)


def _map_values(joint: int, table: MapTable) -> list[ResultValue]:
    return [
        ResultValue("map", f"Δθ{joint}", "mdeg", value, u, 0.0, joint, node, direction)
        for direction, values, us in table.by_direction
        for node, value, u in zip(table.node_deg, values, us, strict=True)
    ]


def parameter_table(result: Result, kinds: Collection[Kind] = KINDS) -> Table:
    """Return parameters, nominal and identified, with their uncertainties."""
    form = fixed(4)
    return Table(
        "values",
        "Parameters",
        (
            Column("name", "parameter"),
            Column("unit", "unit"),
            Column("nominal", "nominal", format=form),
            Column("value", "identified", format=form),
            Column("u", "U (k=2)", format=form, standard=True),
        ),
        tuple(
            (
                value.name,
                value.unit,
                *(Quantity(x, OF_UNIT[value.unit]) for x in (value.nominal, value.value, value.u)),
            )
            for value in result_values(result)
            if value.kind in kinds
        ),
    )

"""What J4 did, as two mountings of the interferometer show it."""

from catseye.app.results.model import Column, Paragraph, Section, Sign, Statement, Table, section
from catseye.app.results.numbers import COUNT, EXPANDED, fixed, number
from catseye.app.results.scara.result import Estimate, J4OrderPart, Result
from catseye.calibration.scara.reversal import SeparatedOrder

_UM = fixed(2)


def separated_part(found: SeparatedOrder) -> J4OrderPart:
    """Return a separated order as a result file states it."""
    u_cosine, u_sine = found.u_parts_mm
    return J4OrderPart(
        contributor=found.contributor,
        order=found.order,
        cosine_um=Estimate(value=1e3 * found.cosine_mm, u=1e3 * u_cosine),
        sine_um=Estimate(value=1e3 * found.sine_mm, u=1e3 * u_sine),
        amplitude_um=Estimate(value=1e3 * found.amplitude_mm, u=1e3 * found.u_mm),
    )


def separated_statements(result: Result) -> list[Statement]:
    """Return what was found of J4; nothing where the interferometer was not turned."""
    return [Statement(Sign.NEUTRAL, _text(name, orders)) for name, orders in _by_contributor(result).items()]


def separated_section(result: Result | None) -> Section:
    """Return the orders of J4 that the two mountings have separated."""
    title = "What J4 adds to a distance"
    parts = [] if result is None else result.j4_orders or []
    if not parts:
        return section("j4", title, ())
    table = Table(
        "j4",
        "Orders of J4's angle that change sign with the mounting (U: k = 2; cosine and sine in the first mounting)",
        (
            Column("contributor", "contributor"),
            Column("order", "order", format=COUNT),
            *(
                column
                for name in ("cosine", "sine", "amplitude")
                for column in (
                    Column(f"{name}_um", name, "µm", _UM),
                    Column(f"u_{name}_um", "U", "µm", _UM, standard=True),
                )
            ),
        ),
        tuple(
            (
                one.contributor,
                one.order,
                *(
                    value
                    for part in (one.cosine_um, one.sine_um, one.amplitude_um)
                    for value in (part.value, part.u)
                ),
            )
            for one in parts
        ),
    )
    note = (
        "An odd order of the motion of J4's axis shows in a distance as the even orders beside it. Even orders of "
        "the motion do not change sign; they stay in the uncertainties."
    )
    return section("j4", title, [table, Paragraph(note)])


def _by_contributor(result: Result) -> dict[str, list[J4OrderPart]]:
    parts = result.j4_orders or []
    return {one.contributor: [each for each in parts if each.contributor == one.contributor] for one in parts}


def _text(name: str, orders: list[J4OrderPart]) -> str:
    found = ", ".join(
        f"{number(one.amplitude_um.value, _UM)} ± {number(EXPANDED * one.amplitude_um.u, _UM)} µm (k = 2) "
        f"in order {one.order}"
        for one in orders
    )
    return (
        f"The interferometer was turned on J4, which separates from the maps what changes sign with it: J4 adds "
        f"{found} of its angle to a distance ({name})."
    )

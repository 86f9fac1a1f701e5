"""A comparison of two results, as a sentence, a table and data."""

from typing import Any

from catseye.app.analysis.result_comparison import (
    Difference,
    MapDifference,
    ResultComparison,
    map_places,
    verdict,
)
from catseye.app.cli.output import table


def comparison_facts(found: ResultComparison) -> dict[str, Any]:
    """Return a comparison as plain values; what is not stated is null."""
    within, count = found.within
    return {
        "values": [_facts(one) for one in found.values],
        "maps": [_map_facts(one) for one in found.maps],
        "reflectors": [_facts(one) for one in found.reflectors],
        "turn_mdeg": found.turn_mdeg,
        "within_2u": within,
        "compared": count,
        "remarks": list(found.remarks),
        "verdict": verdict(found),
    }


def _facts(one: Difference) -> dict[str, Any]:
    return {
        "name": one.name,
        "unit": one.unit,
        "first": one.first,
        "second": one.second,
        "difference": one.difference,
        "u": one.u,
        "normalised": one.normalised,
    }


def _map_facts(one: MapDifference) -> dict[str, Any]:
    facts: dict[str, Any] = {"joint": one.joint, "node_deg": one.node_deg.tolist()}
    for row, direction in enumerate(("positive", "negative")):
        facts[direction] = {
            "first_mdeg": one.first_mdeg[row].tolist(),
            "second_mdeg": one.second_mdeg[row].tolist(),
            "difference_mdeg": one.difference_mdeg[row].tolist(),
            "u_mdeg": one.u_mdeg[row].tolist(),
            "normalised": [None if x != x else x for x in one.normalised[row].tolist()],
        }
    return facts


def comparison_table(found: ResultComparison) -> str:
    """Return the differences as a table."""
    rows = [_row(one) for one in found.values]
    for one in found.maps:
        rows += [
            _row(
                Difference(
                    name,
                    "mdeg",
                    float(one.first_mdeg[row, column]),
                    float(one.second_mdeg[row, column]),
                    float(one.u_mdeg[row, column]),
                )
            )
            for name, row, column in map_places(one)
        ]
    rows += [_row(one) for one in found.reflectors]
    return table(["quantity", "unit", "first", "second", "difference", "u of difference (k=1)", "in u"], rows)


def _row(one: Difference) -> list[str]:
    decimals = 4 if one.unit == "mm" else 2
    figures = [f"{value:.{decimals}f}" for value in (one.first, one.second)]
    in_u = "–" if one.normalised is None else f"{one.normalised:+.2f}"
    return [one.name, one.unit, *figures, f"{one.difference:+.{decimals}f}", f"{one.u:.{decimals}f}", in_u]

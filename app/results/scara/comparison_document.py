"""A comparison of two results as JSON."""

from typing import Any

from catseye.app.results.scara.comparison import Difference, MapDifference, ResultComparison
from catseye.app.results.scara.comparison_report import comparison_statement


def comparison_document(found: ResultComparison) -> dict[str, Any]:
    """Return a comparison as plain values; what is not stated is null."""
    within, count = found.within
    return {
        "values": [_difference(one) for one in found.values],
        "maps": [_map(one) for one in found.maps],
        "reflectors": [_difference(one) for one in found.reflectors],
        "turn_mdeg": found.turn_mdeg,
        "within_2u": within,
        "compared": count,
        "remarks": list(found.remarks),
        "verdict": comparison_statement(found).text,
    }


def _difference(one: Difference) -> dict[str, Any]:
    return {
        "name": one.name,
        "unit": one.unit,
        "first": one.first,
        "second": one.second,
        "difference": one.difference,
        "u": one.u,
        "normalised": one.normalised,
    }


def _map(one: MapDifference) -> dict[str, Any]:
    columns: dict[str, Any] = {"joint": one.joint, "node_deg": one.node_deg.tolist()}
    for row, direction in enumerate(("positive", "negative")):
        columns[direction] = {
            "first_mdeg": one.first_mdeg[row].tolist(),
            "second_mdeg": one.second_mdeg[row].tolist(),
            "difference_mdeg": one.difference_mdeg[row].tolist(),
            "u_mdeg": one.u_mdeg[row].tolist(),
            "normalised": [None if x != x else x for x in one.normalised[row].tolist()],
        }
    return columns

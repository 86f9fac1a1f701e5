"""The emulated arm's true values, in the gauge and at the nodes of an identified result."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from catseye.app.results.numbers import MDEG_PER_RAD
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.identification import Identification


@dataclass(frozen=True)
class TruthComparison:
    """Identified against true values of an error map.

    Attributes:
        names: parameters in the order of the result, dead paths left out.
        units: "mm" or "mdeg" for each.
        identified: estimates.
        truth: true values in the same gauge.
        u: standard uncertainties.
    """

    names: list[str]
    units: list[str]
    identified: Floats
    truth: Floats
    u: Floats

    @property
    def normalised(self) -> Floats:
        """Errors over their standard uncertainties."""
        return (self.identified - self.truth) / self.u

    @property
    def rms_normalised(self) -> float:
        """Rms of the normalised errors; about 1 when the uncertainties are honest."""
        return float(np.sqrt(np.mean(self.normalised**2)))


def compare_with_truth(identified: Identification, truth: dict[str, Any]) -> TruthComparison:
    """Compare an identified error map with a truth document.

    The truth is brought into the gauge of the result: its J1 map is shifted to a mean of zero over the nodes of
    both directions, and its reflectors are turned by the same angle.

    Args:
        truth: result JSON document with the true arm.
    """
    layout = identified.layout
    map1 = _at_nodes(truth["theta1_map"], layout.nodes1_rad)
    map2 = _at_nodes(truth["theta2_map"], layout.nodes2_rad)
    turn = gauge_turn_rad(identified, truth)
    places = [_turned(truth, name, turn) for name in layout.reflector_names]
    links = [truth["link1_mm"]["value"], truth["link2_mm"]["value"]]
    n = layout.reflectors.stop
    scale = np.ones(n)
    scale[layout.map1.start : layout.map2.stop] = MDEG_PER_RAD
    true = np.concatenate([links, map1 - turn, map2, np.ravel(places)])
    return TruthComparison(
        names=layout.names()[:n],
        units=["mdeg" if factor != 1.0 else "mm" for factor in scale],
        identified=identified.parameters[:n] * scale,
        truth=true * scale,
        u=identified.standard_uncertainty[:n] * scale,
    )


def gauge_turn_rad(identified: Identification, truth: dict[str, Any]) -> float:
    """Return the mean of the true J1 map over the identified nodes of both directions, rad."""
    return float(_at_nodes(truth["theta1_map"], identified.layout.nodes1_rad).mean())


def _at_nodes(table: dict[str, Any], nodes_rad: Floats) -> Floats:
    """Return a true map at nodes, positive table then negative, rad; held constant beyond its ends."""
    own = np.deg2rad(table["node_deg"])
    tables = [np.deg2rad(1e-3 * np.asarray(table[key])) for key in ("positive_mdeg", "negative_mdeg")]
    return np.concatenate([np.interp(nodes_rad, own, values) for values in tables])


def turned_places(truth: dict[str, Any], turn_rad: float) -> dict[str, tuple[float, float]]:
    """Return the true places, turned against the shift of the J1 map, mm."""
    return {place["name"]: _turned(truth, place["name"], turn_rad) for place in truth["reflectors"]}


def _turned(truth: dict[str, Any], name: str, turn_rad: float) -> tuple[float, float]:
    place = next(place for place in truth["reflectors"] if place["name"] == name)
    x, y = place["x_mm"]["value"], place["y_mm"]["value"]
    cosine, sine = np.cos(turn_rad), np.sin(turn_rad)
    return float(cosine * x + sine * y), float(cosine * y - sine * x)

"""The true arm: what the identification is meant to find out.

A truth is drawn from a seed or read from a result file (`catseye-result/1`); uncertainties in it are ignored.
Outside its nodes a true map is held constant: the arm has some deviation there too, but nobody measured it.
"""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, ValidationError

from catseye.simulators.config import EmulationConfig, Range, TruthText
from catseye.simulators.errors import TruthFileError
from catseye.simulators.world.scara.axis_errors import JointMap
from catseye.simulators.world.types import Floats

FORMAT = "catseye-result/1"


@dataclass(frozen=True)
class TrueArm:
    """Geometry and error maps as they really are.

    Attributes:
        link1_mm: length of link 1 at bench time 0, mm.
        link2_mm: length of link 2 at bench time 0, mm.
        theta1_map: angular positioning deviation of J1.
        theta2_map: angular positioning deviation of J2.
        reflectors: places of the reflectors' centres, name to (x_mm, y_mm).
        theta40_rad: direction of the beam at J4 = 0 on an arm straight along +X, rad.
    """

    link1_mm: float
    link2_mm: float
    theta1_map: JointMap
    theta2_map: JointMap
    reflectors: dict[str, tuple[float, float]] = field(default_factory=dict)
    theta40_rad: float = 0.0


def draw_truth(seed: int, config: EmulationConfig) -> TrueArm:
    """Draw a plausible arm: the same seed and configuration give the same arm.

    Args:
        config: nominal links, joint limits and rough places of the reflectors.
    """
    rng = np.random.default_rng([seed, 1])
    link1_mm, link2_mm = rng.normal((config.scara.link1_mm, config.scara.link2_mm), 0.03)
    theta1 = _draw_map(rng, config.limits[0], 0.0, (9.0, 12.0, 9.0))
    theta2 = _draw_map(rng, config.limits[1], -5.5, (6.0, 11.0, 9.0))
    theta40_deg = rng.normal(0.0, 1.0)
    reflectors = _draw_reflectors(seed, config)
    return TrueArm(link1_mm, link2_mm, theta1, theta2, reflectors, float(np.deg2rad(theta40_deg)))


def _draw_reflectors(seed: int, config: EmulationConfig) -> dict[str, tuple[float, float]]:
    rng = np.random.default_rng([seed, 2])
    shifts = rng.normal(0.0, 3.0, (len(config.reflectors), 2))
    places = zip(config.reflectors, shifts, strict=True)
    return {place.name: (place.x_mm + float(dx), place.y_mm + float(dy)) for place, (dx, dy) in places}


def _draw_map(
    rng: np.random.Generator, limits_deg: Range, offset_mdeg: float, amplitudes_mdeg: tuple[float, ...]
) -> JointMap:
    span_deg = limits_deg[1] - limits_deg[0]
    nodes_deg = np.linspace(*limits_deg, max(2, int(np.ceil(span_deg)) + 1))
    nodes = np.deg2rad(nodes_deg)
    smooth_mdeg = np.full(nodes.shape, offset_mdeg)
    for order, amplitude_mdeg in enumerate(amplitudes_mdeg, start=1):
        smooth_mdeg += amplitude_mdeg * np.sin(order * nodes + rng.uniform(0.0, 2.0 * np.pi))
    # A strain wave gear repeats its error twice in a turn of the motor: a high order of the joint's angle.
    smooth_mdeg += 0.7 * np.sin(50.0 * nodes + rng.uniform(0.0, 2.0 * np.pi))
    backlash_mdeg = rng.uniform(19.0, 23.0) + np.sin(nodes + rng.uniform(0.0, 2.0 * np.pi))
    to_rad = np.pi / 180e3
    return JointMap(
        nodes, to_rad * (smooth_mdeg - backlash_mdeg / 2.0), to_rad * (smooth_mdeg + backlash_mdeg / 2.0)
    )


class _Part(BaseModel):
    """Part of a result file; a number must be a number, keys beyond those used here are somebody else's."""

    model_config = ConfigDict(strict=True, allow_inf_nan=False)


class _Value(_Part):
    value: float


class _Map(_Part):
    node_deg: list[float]
    positive_mdeg: list[float]
    negative_mdeg: list[float]


class _Reflector(_Part):
    name: str
    x_mm: _Value
    y_mm: _Value


class _Document(_Part):
    format: Literal["catseye-result/1"]
    link1_mm: _Value
    link2_mm: _Value
    theta20_mdeg: _Value | None = None
    theta1_map: _Map | None = None
    theta2_map: _Map | None = None
    reflectors: list[_Reflector] = []
    theta40_deg: float | None = None


def true_arm(text: TruthText, config: EmulationConfig) -> TrueArm:
    """Read a true arm; what the document leaves out is drawn from the configuration's seed.

    Args:
        text: document in the result format; the extra key `theta40_deg` (a number, deg) is optional.
        config: where reflectors and the beam's direction come from if the file does not have them.

    Raises:
        TruthFileError: the document does not fit; the text names file and key.
    """
    document, path = _read(text), text.source
    drawn = draw_truth(config.seed, config)
    found = {r.name: (r.x_mm.value, r.y_mm.value) for r in document.reflectors}
    theta40_deg = document.theta40_deg
    return TrueArm(
        link1_mm=_positive(document.link1_mm.value, path, "link1_mm"),
        link2_mm=_positive(document.link2_mm.value, path, "link2_mm"),
        theta1_map=_map(document.theta1_map, document, path, "theta1_map"),
        theta2_map=_map(document.theta2_map, document, path, "theta2_map"),
        reflectors=drawn.reflectors | found,
        theta40_rad=drawn.theta40_rad if theta40_deg is None else float(np.deg2rad(theta40_deg)),
    )


def _read(text: TruthText) -> _Document:
    try:
        return _Document.model_validate_json(text.raw)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"]) or "(document)"
        raise TruthFileError(f"{text.source}: {key}: {first['msg']}") from error


def _positive(length_mm: float, path: str, key: str) -> float:
    if length_mm <= 0.0:
        raise TruthFileError(f"{path}: {key}.value: a link must be longer than 0 mm, found {length_mm:g}")
    return length_mm


def _map(table: _Map | None, document: _Document, path: str, key: str) -> JointMap:
    if table is None:
        return _constant_map(document, path, key)
    to_rad = np.pi / 180e3
    try:
        return JointMap(
            np.deg2rad(np.array(table.node_deg)),
            to_rad * np.array(table.positive_mdeg),
            to_rad * np.array(table.negative_mdeg),
        )
    except ValueError as error:
        raise TruthFileError(f"{path}: {key}: {error}") from error


def _constant_map(document: _Document, path: str, key: str) -> JointMap:
    if document.theta20_mdeg is None:
        raise TruthFileError(
            f"{path}: {key}: missing; give both maps, or theta20_mdeg for a conventional model"
        )
    theta20_rad = document.theta20_mdeg.value * np.pi / 180e3
    value = np.array([theta20_rad if key == "theta2_map" else 0.0])
    return JointMap(np.zeros(1), value, value)


def truth_document(truth: TrueArm) -> dict[str, object]:
    """Return the arm in the result format (uncertainties 0), ready for `json.dump` and for `true_arm`."""
    return {
        "format": FORMAT,
        "model": "error-map",
        "gauge": "true arm, not in the gauge of an identification",
        "link1_mm": _exact(truth.link1_mm),
        "link2_mm": _exact(truth.link2_mm),
        "theta1_map": _map_document(truth.theta1_map),
        "theta2_map": _map_document(truth.theta2_map),
        "reflectors": [
            {"name": name, "x_mm": _exact(x_mm), "y_mm": _exact(y_mm)}
            for name, (x_mm, y_mm) in truth.reflectors.items()
        ],
        "theta40_deg": float(np.rad2deg(truth.theta40_rad)),
        "dead_paths": [],
        "fit": {},
        "provenance": {"runs": [], "software": "catseye emulated bench", "created": ""},
    }


def _exact(value: float) -> dict[str, float]:
    return {"value": float(value), "u": 0.0}


def _map_document(table: JointMap) -> dict[str, list[float]]:
    zeros = [0.0] * table.nodes_rad.size
    return {
        "node_deg": _listed(np.rad2deg(table.nodes_rad)),
        "positive_mdeg": _listed(np.rad2deg(table.positive_rad) * 1e3),
        "negative_mdeg": _listed(np.rad2deg(table.negative_rad) * 1e3),
        "u_positive_mdeg": zeros,
        "u_negative_mdeg": zeros,
    }


def _listed(values: Floats) -> list[float]:
    return [float(value) for value in values]

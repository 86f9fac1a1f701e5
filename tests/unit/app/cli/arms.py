"""Result files of arms whose every position can be worked out by hand."""

import json
from pathlib import Path
from typing import Any

UP1, DOWN1 = [10.0, 30.0], [-10.0, 10.0]
"""J1 map at 0° and 90°, mdeg."""

UP2, DOWN2 = [5.0, 5.0], [-5.0, -5.0]
"""J2 map at 0° and 120°, mdeg."""


def estimate(value: float, u: float) -> dict[str, float]:
    return {"value": value, "u": u}


def bare_map(nodes: list[float], up: list[float], down: list[float], u: float) -> dict[str, list[float]]:
    us = [u] * len(nodes)
    names = ("node_deg", "positive_mdeg", "negative_mdeg", "u_positive_mdeg", "u_negative_mdeg")
    return dict(zip(names, (nodes, up, down, us, us), strict=True))


def bare(model: str = "error-map") -> dict[str, Any]:
    """Return a result with the keys of version 1 alone, those that its model does not use at zero."""
    return {
        "format": "catseye-result/1",
        "model": model,
        "gauge": "mean of theta1 map = 0",
        "link1_mm": estimate(325.1, 0.002),
        "link2_mm": estimate(224.9, 0.003),
        "theta20_mdeg": estimate(20.0 if model == "conventional" else 0.0, 1.0),
        "theta1_map": bare_map([0.0, 90.0], UP1, DOWN1, 0.5),
        "theta2_map": bare_map([0.0, 120.0], UP2, DOWN2, 0.7),
        "reflectors": [],
        "dead_paths": [],
        "fit": {
            "n_points": 0,
            "n_parameters": 0,
            "dof": 0,
            "rms_um": 0,
            "sigma0_um": 0,
            "iterations": 0,
            "rejected": [],
            "null_directions": [],
        },
        "provenance": {"runs": [], "software": "", "created": ""},
    }


def stored(folder: Path, content: dict[str, Any], name: str = "result.json") -> Path:
    path = folder / name
    path.write_text(json.dumps(content), encoding="utf-8")
    return path


def text_file(folder: Path, text: str, name: str = "path.csv") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path

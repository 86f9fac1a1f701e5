"""Two small results of one arm, with numbers that are easily checked by hand, and what commands print about them."""

import json
import math
import os
from pathlib import Path
from typing import Any, Final

import numpy as np

from catseye.app.results.figures import Axis, Figure, Level, Line, Panel, Points, Role, Text
from catseye.app.results.scara.diagnosis_document import (
    DiagnosedFit,
    DiagnosisDocument,
    DiagnosisFinding,
    InfluentialDistance,
    NodesPart,
    Outlier,
    Outliers,
)
from catseye.app.results.scara.validation_document import (
    AlignmentPart,
    DeviationPart,
    Fitted,
    ModelOnPathPart,
    PathPart,
    ValidationDocument,
)

NODES1 = [-40.0, 0.0, 40.0]
NODES2 = [20.0, 60.0, 100.0]
RUN = "20261119T081500Z_open-loop_aaaaaa"
WRITTEN_S = 1_795_000_000


def estimate(value: float, u: float) -> dict[str, float]:
    return {"value": value, "u": u}


def table(nodes: list[float], positive: list[float], negative: list[float], u: float) -> dict[str, Any]:
    return {
        "node_deg": nodes,
        "positive_mdeg": positive,
        "negative_mdeg": negative,
        "u_positive_mdeg": [u] * len(nodes),
        "u_negative_mdeg": [u / 2.0] * len(nodes),
    }


def residuals() -> dict[str, Any]:
    """Forty distances to two reflectors; number 7 is 60 µm off, number 31 −45 µm."""
    values = [5.0 * math.sin(1.7 * number) for number in range(1, 41)]
    values[6], values[30] = 60.0, -45.0
    return {
        "reflector": ["P1"] * 20 + ["P2"] * 20,
        "segment": [0] * 40,
        "theta1_deg": [-40.0 + 2.0 * number for number in range(40)],
        "theta2_deg": [20.0 + 40.0 * (number % 3) for number in range(40)],
        "direction1": [1] * 40,
        "direction2": [1, -1] * 20,
        "residual_um": values,
    }


def error_map() -> dict[str, Any]:
    return {
        "format": "catseye-result/1",
        "model": "error-map",
        "gauge": "mean of theta1 map = 0",
        "link1_mm": estimate(325.0123, 0.004),
        "link2_mm": estimate(224.9911, 0.003),
        "theta1_map": table(NODES1, [-12.0, 20.0, -6.0], [-2.0, 4.0, -4.0], 1.5),
        "theta2_map": table(NODES2, [-30.25, -10.0, 5.0], [-10.0, 12.0, 25.0], 2.5),
        "reflectors": [
            {"name": "P1", "x_mm": estimate(650.125, 0.02), "y_mm": estimate(-400.5, 0.03)},
            {"name": "P2", "x_mm": estimate(680.0, 0.02), "y_mm": estimate(12.0, 0.03)},
        ],
        "dead_paths": [
            {"reflector": "P1", "segment": 0, "length_mm": estimate(512.3456, 0.025)},
            {"reflector": "P2", "segment": 0, "length_mm": estimate(498.7, 0.025)},
        ],
        "fit": {
            "n_points": 40,
            "n_parameters": 20,
            "dof": 20,
            "rms_um": 12.3,
            "sigma0_um": 13.0,
            "iterations": 3,
            "rejected": ["row 12 (reflector P1) 140 µm off"],
            "null_directions": [],
            "chi2_reduced": 1.1,
            "chi2_probability": 0.3,
        },
        "nominal": {"link1_mm": 325.0, "link2_mm": 225.0},
        "residuals": residuals(),
        "provenance": {"runs": [RUN], "software": "test", "created": "", "simulated": True},
    }


def conventional() -> dict[str, Any]:
    whole = {**error_map(), "model": "conventional", "theta20_mdeg": estimate(4.0, 0.5)}
    del whole["theta1_map"], whole["theta2_map"]
    return whole


def later() -> dict[str, Any]:
    """The same arm, measured again: L1 longer by 20 µm, one node of Δθ2 changed by 5 mdeg."""
    whole = {**error_map(), "link1_mm": estimate(325.0323, 0.003)}
    whole["theta2_map"] = table(NODES2, [-30.25, -5.0, 5.0], [-10.0, 12.0, 25.0], 2.5)
    whole["provenance"] = {**whole["provenance"], "runs": ["20261120T081500Z_open-loop_abcdef"]}
    return whole


def write_results(folder: Path) -> None:
    """Write them, the error map last, and a file that is none."""
    files = {"conventional.json": conventional(), "later.json": later(), "error-map.json": error_map()}
    for place, (name, content) in enumerate(files.items()):
        path = folder / name
        path.write_text(json.dumps(content), encoding="utf-8")
        os.utime(path, (WRITTEN_S + 60 * place, WRITTEN_S + 60 * place))
    broken = folder / "broken.json"
    broken.write_text('{"format": "catseye-result/1", "model": "error-map"}', encoding="utf-8")
    os.utime(broken, (WRITTEN_S, WRITTEN_S))
    (folder / "other.json").write_text('{"a": 1}', encoding="utf-8")


def _outlier(row: int, what: str, residual_um: float, external: float) -> Outlier:
    return Outlier(
        row=row,
        what=what,
        residual_um=residual_um,
        internal=external,
        external=external,
        leverage=0.2,
        cook=0.1,
    )


def _order_figure() -> Figure:
    """Return residuals in measuring order with two numbered outliers."""
    size = np.sin(1.7 * np.arange(1.0, 41.0))
    size[6], size[30] = 9.4, -6.1
    marks = (
        Points(np.arange(1.0, 41.0), size, 0, "reflector P1", size=2.4),
        Level(3.9, Role.CHANGE, dash="dashed"),
        Text("1", (7.0, 9.4), Role.CHANGE),
        Text("2", (31.0, -6.1), Role.CHANGE),
    )
    panel = Panel("", Axis("distance in measuring order"), Axis("studentised residual"), marks)
    return Figure("diagnosis-order", "Residuals", "Dashed: the limit.", ((panel,),))


DIAGNOSIS: Final = DiagnosisDocument(
    sources=[RUN],
    findings=[
        DiagnosisFinding(kind="good", text="The error map leaves 12.3 µm rms in 40 distances."),
        DiagnosisFinding(kind="bad", text="2 distances stand out: the farthest is row 7."),
    ],
    fit=DiagnosedFit(n_points=40, n_parameters=20, rms_um=12.3, chi2_reduced=1.1, rejected=[]),
    models=[],
    outliers=Outliers(
        limit=3.9,
        distances=[
            _outlier(7, "row 7 (reflector P1, θ1 -28°)", -60.0, -9.4),
            _outlier(31, "row 31 (reflector P2, θ1 20°)", 45.0, 6.1),
        ],
        largest_leverage=0.3,
        most_influential=InfluentialDistance(row=7, what="row 7", cook=0.1),
    ),
    changes=[],
    patterns=[],
    harmonics=[],
    cross_validation=[],
    nodes=NodesPart(
        commands_between_nodes_of_j1=False,
        commands_between_nodes_of_j2=False,
        best_aicc="",
        best_bic="",
        best_prediction=None,
        grids=[],
    ),
    figures=(_order_figure(),),
)


def _on_path(model: str, title: str, rms_um: float) -> ModelOnPathPart:
    none = Fitted(value=0.0, u=0.0)
    return ModelOnPathPart(
        model=model,
        title=title,
        alignment=AlignmentPart(rotation_mdeg=none, shift_x_mm=none, shift_y_mm=none),
        rms_x_um=rms_um,
        rms_y_um=0.0,
        rms_um=rms_um,
        max_um=40.0,
        max_line=2,
        ratio=rms_um / 25.0,
        median_u_um=5.0,
        expected_um=10.0,
        expected_parts_um={},
        share_explained=None,
        within_2u=None,
        probability=0.5,
    )


def validation() -> ValidationDocument:
    """Return a validation on a straight path: the error map leaves 2 µm, the other 25."""
    way = [-300.0 + 20.0 * place for place in range(31)]
    true = [60.0 * math.sin(y / 100.0) for y in way]
    seen = [value + (2.0 if place % 2 else -2.0) for place, value in enumerate(true)]
    plain = [value - 25.0 for value in true]
    models = {"conventional": "conventional model", "error-map": "error map"}
    at = np.array(way)
    marks = (
        Points(at, np.array(seen), Role.POSITIVE, "measured", marker="x"),
        Line(at, np.array(plain), Role.CONVENTIONAL, "conventional model"),
        Line(at, np.array(true), Role.NEGATIVE, "error map", "dashed"),
    )
    panels = tuple(Panel("", Axis("Y / mm"), Axis("µm", symbol), marks) for symbol in ("E_{YY}", "E_{XY}"))
    return ValidationDocument(
        rows=33,
        compared=31,
        left_out=["2 of 33 rows lie outside the identified range"],
        warnings=[],
        models=[
            _on_path(model, title, rms_um)
            for (model, title), rms_um in zip(models.items(), (25.0, 2.0), strict=True)
        ],
        ratio=0.08,
        limit_um=None,
        within_limit=None,
        iso230_2=[],
        iso9283=[],
        path=PathPart(
            axis="Y / mm",
            axis_mm=way,
            line=list(range(2, 33)),
            way_there=[True] * 31,
            models=list(models.values()),
            deviations=[
                DeviationPart(symbol=symbol, what="", measured_um=seen, predicted_um=[plain, true])
                for symbol in ("E_YY", "E_XY")
            ],
        ),
        verdict=["error map: 2.0 µm are left"],
        figures=(Figure("path", "Path", "Actual minus command.", (panels,)),),
    )

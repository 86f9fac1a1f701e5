"""What the demo found, as text and as data."""

from pathlib import Path

from catseye.app.analysis.validation import ModelOnPath
from catseye.app.cli.demo_job import DemoResult
from catseye.app.cli.output import table


def demo_text(result: DemoResult) -> str:
    """Return parameters, fit and models on the path."""
    truth = result.truth
    header = ["parameter", "unit", "truth", "identified", "u (k=1)", "error/u"]
    rows = [
        [name, unit, *(_number(value, unit) for value in (true, found, u)), f"{error:+.2f}"]
        for name, unit, true, found, u, error in zip(
            truth.names, truth.units, truth.truth, truth.identified, truth.u, truth.normalised, strict=True
        )
    ]
    fit = result.results["error-map"].fit
    paths = ["", "validation path", *(f"  {line}" for line in _path_lines(result)), ""]
    quality = (
        f"{fit.n_points} distances, residuals {fit.rms_um:.1f} µm rms; errors over their u: "
        f"{truth.rms_normalised:.2f} rms (1 is honest)"
    )
    return "\n".join([table(header, rows), "", quality, *paths])


def _path_lines(result: DemoResult) -> list[str]:
    validation = result.validation
    left_out = int((~validation.compared).sum())
    header = ["model", "E_YY rms µm", "E_XY rms µm", "2-D rms µm", "max µm"]
    rows = [_model_row(model) for model in validation.models]
    lines = table(header, rows).splitlines()
    compared = int(validation.compared.sum())
    lines.append(
        f"{compared} points compared, {left_out} left out (θ2 beyond the nodes, or a joint just reversed)"
    )
    if validation.ratio is not None:
        lines.append(f"the error map leaves {validation.ratio:.2f} of the conventional model's error")
    return lines


def _model_row(model: ModelOnPath) -> list[str]:
    comparison = model.comparison
    x_um, y_um = comparison.rms_um
    return [model.model, *(f"{value:.1f}" for value in (y_um, x_um, comparison.rms_2d_um, comparison.max_um))]


def _number(value: float, unit: str) -> str:
    return f"{value:.4f}" if unit == "mm" else f"{value:.2f}"


def demo_facts(result: DemoResult, report: Path) -> dict[str, object]:
    """Return where everything is, and what was found, as plain values."""
    truth = result.truth
    models = {
        model.model: {
            "e_yy_rms_um": model.comparison.rms_um[1],
            "e_xy_rms_um": model.comparison.rms_um[0],
            "rms_2d_um": model.comparison.rms_2d_um,
            "max_um": model.comparison.max_um,
        }
        for model in result.validation.models
    }
    return {
        "runs": {name: str(path) for name, path in result.runs.items()},
        "run": str(result.runs["open-loop"]),
        "report": str(report),
        "truth": str(result.folder / "truth.json"),
        "results": {model: str(result.folder / f"result-{model}.json") for model in result.results},
        "identified": [
            {"name": n, "unit": unit, "truth": float(t), "identified": float(i), "u": float(u)}
            for n, unit, t, i, u in zip(
                truth.names, truth.units, truth.truth, truth.identified, truth.u, strict=True
            )
        ],
        "rms_normalised_error": truth.rms_normalised,
        "fit": result.results["error-map"].fit.model_dump(exclude_none=True),
        "validation": {
            "models": models,
            "ratio": result.validation.ratio,
            "compared": int(result.validation.compared.sum()),
            "left_out": int((~result.validation.compared).sum()),
        },
    }

"""Draws the pictures of the README from a demo: python docs/pictures.py DEMO-FOLDER."""

import sys
from pathlib import Path

from catseye.app.analysis.reporting import demo_truth
from catseye.app.cli.demo_job import evaluate
from catseye.app.report.figures.canvas import svg
from catseye.app.report.figures.error_maps import error_map_figure
from catseye.app.report.figures.path_deviation import path_figure
from catseye.app.report.figures.trajectories import trajectory_figure
from catseye.app.report.path_view import gaps
from catseye.app.store.catalog import list_runs


def main(folder: Path) -> None:
    """Write the pictures into docs/images."""
    result = evaluate(folder, {run.procedure: run.path for run in list_runs(folder / "runs")})
    error_map = result.results["error-map"]
    pictures = {
        "error-maps": error_map_figure(error_map, demo_truth(result)),
        "validation-path": path_figure(result.validation, gaps(result.validation, error_map)),
        "trajectories": trajectory_figure(result.validation),
    }
    images = Path(__file__).parent / "images"
    for name, figure in pictures.items():
        (images / f"{name}.svg").write_text(svg(figure, name, name), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))

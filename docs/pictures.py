"""Draws the pictures of the README from a demo: python docs/pictures.py DEMO-FOLDER."""

import sys
from pathlib import Path

from catseye.app.cli.scara.demo_job import evaluate
from catseye.app.files.documents import read_truth
from catseye.app.render.canvas import svg
from catseye.app.render.mpl import drawn
from catseye.app.results.scara.figures.maps import map_figure
from catseye.app.results.scara.figures.path import path_figures
from catseye.app.results.scara.figures.trajectories import trajectory_figure
from catseye.app.results.scara.path_view import gaps
from catseye.app.results.scara.truth_tables import truth_tables
from catseye.app.store.catalog import list_runs


def main(folder: Path) -> None:
    """Write the pictures into docs/images."""
    result = evaluate(folder, {run.procedure: run.path for run in list_runs(folder / "runs")})
    error_map = result.results["error-map"]
    truth = truth_tables(result.identified["error-map"], read_truth(folder / "truth.json"))
    pictures = {
        "error-maps": map_figure(error_map, truth),
        "validation-path": path_figures(result.validation, gaps(result.validation, error_map))[0],
        "trajectories": trajectory_figure(result.validation),
    }
    images = Path(__file__).parent / "images"
    for name, figure in pictures.items():
        if figure is not None:
            (images / f"{name}.svg").write_text(svg(drawn(figure), name, name), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))

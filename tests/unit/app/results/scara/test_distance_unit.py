"""Distances of a file in another unit, or of reversed sign: no fit finds it out, so it is refused beforehand."""

from pathlib import Path

import numpy as np
import pytest

from catseye.app.cell.bench import scara_bench_of
from catseye.app.cell.load import load_cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.errors import UsageError
from catseye.app.results.scara.distances import load_distances
from catseye.app.results.scara.points import COLUMNS
from catseye.app.results.scara.scan import identify_scan_file
from catseye.app.results.scara.stated_budget import budget_of_table


def written(folder: Path, factor: float) -> Path:
    """Write distances of the paper's arm to reflectors 15 mm from their rough places, times a factor."""
    (folder / "cell.toml").write_text(TEMPLATE, encoding="utf-8")
    bench = scara_bench_of(load_cell(folder / "cell.toml").cell)
    lines = [",".join(COLUMNS)]
    for reflector in bench.reflectors:
        for theta1 in bench.nodes1_deg:
            for theta2 in bench.nodes2_deg:
                a, b = np.deg2rad([theta1, theta1 + theta2])
                x, y = 325.0 * np.cos(a) + 225.0 * np.cos(b), 325.0 * np.sin(a) + 225.0 * np.sin(b)
                away = (reflector.x_mm + 12.0 - x, reflector.y_mm - 9.0 - y)
                lines.append(
                    f"{reflector.name},0,{theta1},{theta2},1,1,{factor * float(np.hypot(*away) - 700.0)!r}"
                )
    path = folder / "points.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("factor", "unit"),
    [(1e3, "µm"), (1e-3, "m"), (0.1, "cm"), (1.0 / 25.4, "inches"), (25.4, "mm that were")],
)
def test_other_units_are_named(tmp_path: Path, factor: float, unit: str) -> None:
    path = written(tmp_path, factor)
    with pytest.raises(UsageError, match=rf"points\.csv: .* seem to be in {unit}.*: convert them to mm"):
        load_distances([], path, tmp_path / "cell.toml", None)


def test_a_reversed_sign_is_reported(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"falls where the beam grows longer .* reverse its sign"):
        load_distances([], written(tmp_path, -1.0), tmp_path / "cell.toml", None)


def test_millimetres_are_taken(tmp_path: Path) -> None:
    source = load_distances([], written(tmp_path, 1.0), tmp_path / "cell.toml", None)
    assert len(source.points) == 3 * 11 * 8


def test_a_streamed_file_is_looked_at_as_well(tmp_path: Path) -> None:
    path = written(tmp_path, 1e3)
    cell = load_cell(tmp_path / "cell.toml").cell
    with pytest.raises(UsageError, match="seem to be in µm"):
        identify_scan_file(
            path,
            scara_bench_of(cell),
            "error-map",
            lambda seen: budget_of_table(seen, cell.uncertainty, "cell.toml"),
        )

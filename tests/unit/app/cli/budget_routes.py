"""One measurement on every way into identify."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from catseye.app.cli.export import export
from catseye.app.cli.scara.identify import identify
from catseye.app.results.scara import scan
from catseye.app.results.scara.result import Result, read_result
from catseye.app.results.scara.values import result_values
from catseye.app.store.reader import RunReader
from catseye.calibration.core.types import Floats

EQUAL = 1e-6
"""The figure of the issue: of u for values, relative for u."""


def of_table(folder: Path, name: str, **options: Any) -> Result:
    """Identify from a points file."""
    identify(folder / "result.json", [], folder / name, folder / "cell.toml", **options)
    return read_result(folder / "result.json")


def of_every_route(folder: Path, run: RunReader, monkeypatch: pytest.MonkeyPatch) -> dict[str, Result]:
    """Identify a run, its tables, and its tables as if they were long scans."""
    identify(folder / "result.json", [str(run.path)])
    found = {"run": read_result(folder / "result.json")}
    for name in ("points.csv", "points.parquet"):
        export(str(run.path), folder / name, None, None)
        found[name] = of_table(folder, name)
    with monkeypatch.context() as patched:
        patched.setattr(scan, "SCAN_ROWS", 100)
        patched.setattr(scan, "_SHORTEST_LINE_BYTES", 1)
        for name in ("points.csv", "points.parquet"):
            found[f"scan of {name}"] = of_table(folder, name)
            assert found[f"scan of {name}"].scan is not None
    return found


def figures(result: Result) -> tuple[Floats, Floats]:
    """Return all values and all standard uncertainties."""
    rows = result_values(result)
    return np.array([row.value for row in rows]), np.array([row.u for row in rows])


def differences(result: Result, reference: Result) -> tuple[float, float]:
    """Return the largest difference of values in u, and of u relatively."""
    (values, u), (expected, expected_u) = figures(result), figures(reference)
    by_value = float(np.max(np.abs(values - expected) / expected_u))
    return by_value, float(np.max(np.abs(u / expected_u - 1.0)))

"""The day of each system by keys alone: from an empty folder to the certificate, without a shell."""

import json
import os
import re
from collections.abc import Callable
from html import unescape
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest

from catseye.app.cell.load import load_cell
from catseye.app.tui.setup.emulators import emulated_cell
from tests.system.command import ask_bench
from tests.system.day_by_keys import beginning

SPEED = "400"
MOST_KEYS: Final = 30
WHOLE: Final = bool(os.environ.get("CATSEYE_WHOLE_DAY"))
"""With every node of the maps; `make day-by-keys`."""

_NODES: Final = {
    "theta1_deg = [-140.0, -120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0]": (
        "theta1_deg = [-20.0, 0.0, 20.0, 40.0, 60.0]"
    ),
    "theta2_deg = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0]": (
        "theta2_deg = [20.0, 40.0, 60.0, 80.0, 100.0]"
    ),
}


def with_fewer_nodes(text: str) -> str:
    """Return a cell file with nodes as close as they were, on a smaller part of the ranges."""
    for nodes, fewer in _NODES.items():
        assert nodes in text
        text = text.replace(nodes, fewer)
    return text


def truth_of(cell: Path) -> dict[str, Any]:
    """Ask the emulated bench how its arm really is."""
    tracker = load_cell(cell).cell.tracker
    assert tracker is not None
    host, _, port = (tracker.control or tracker.endpoint).removeprefix("tcp://").rpartition(":")
    truth: dict[str, Any] = ask_bench((host, int(port)), op="truth")["truth"]
    return truth


def said_on(page: Path) -> str:
    """Return the words of a page."""
    text = re.sub(r"<(style|svg|script).*?</\1>", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    return " ".join(unescape(re.sub(r"<[^>]+>", " ", text)).split())


def assert_found(result: dict[str, Any], truth: dict[str, Any]) -> None:
    """Hold links and maps against the bench: 4 u, one case in 16 000 lies outside."""
    for name in ("link1_mm", "link2_mm"):
        assert abs(result[name]["value"] - truth[name]["value"]) < 4.0 * result[name]["u"], name
    for name in ("theta1_map", "theta2_map"):
        found, real = result[name], truth[name]
        for side in ("positive_mdeg", "negative_mdeg"):
            at_nodes = np.interp(found["node_deg"], real["node_deg"], real[side])
            difference = np.array(found[side]) - at_nodes
            u_mdeg = np.array(found[f"u_{side}"])
            assert np.all(np.abs(difference) < 4.0 * u_mdeg), (name, side, difference, u_mdeg)


@pytest.mark.slow
def test_scara_day_takes_thirty_keys(tmp_path: Path, record_property: Callable[[str, object], None]) -> None:
    cell = tmp_path / "emulated-bench.toml"
    (tmp_path / "part.csv").write_text("x_mm,y_mm\n200,350\n200,400\n200,450\n", encoding="utf-8")
    with beginning(tmp_path, SPEED) as day:
        day.screen.shows("knows of no bench yet")
        if not WHOLE:
            # Set-up takes an emulated bench that is there as it is.
            cell.write_text(with_fewer_nodes(emulated_cell("scara")), encoding="utf-8")
        day.emulate("4")
        day.press("f3")
        for stage in ("beam-level", "beam-to-j4", "reflector-search", "warmup", "open-loop"):
            day.moves(stage)
        day.works("identify")
        day.works("identify conventional")
        day.moves("validation-path")
        day.works("validate")
        day.works("compensate", *"part.csv", "enter")
        day.works("report")
        day.works("dossier")
        truth = truth_of(cell)
        day.quit()
    record_property("keys", (day.keys, day.answers))
    record_property("took_s", day.took_s)
    assert day.keys <= MOST_KEYS
    (path,) = tmp_path.glob("result-*.json")
    result = json.loads(path.read_text(encoding="utf-8"))
    assert_found(result, truth)
    said = said_on(tmp_path / "dossier-emulated-bench.html")
    assert "Certificate" in said
    assert "11 of 13 stages done" in said
    for name, label in (("link1_mm", "L1"), ("link2_mm", "L2")):
        assert re.search(
            rf"{label} mm [\d.]+ {result[name]['value']:.4f} {2.0 * result[name]['u']:.4f}", said
        ), label

"""The search of a reflector with each interferometer, as two processes over sockets."""

import json
from pathlib import Path

import pytest

from tests.system.command import catseye, emulated, only

LINES = 'driver = "line-counter"\n'
PROFILE = 'profile = "default"\n'
SPEED = "50"


@pytest.mark.slow
@pytest.mark.parametrize("driver", ["attocube-ids", "heidenhain-nd", "lasertex-hpi", "umd"])
def test_the_search_works_with(driver: str, tmp_path: Path) -> None:
    edit = {LINES: f'driver = "{driver}"\n', PROFILE: "", **only("P2")}
    with emulated(tmp_path, "--speed", SPEED, "--seed", "3", edit=edit) as bench:
        looked = catseye("doctor", bench.cell, "--json", cwd=tmp_path)
        searched = catseye("run", "reflector-search", "--cell", bench.cell, "--speed", SPEED, cwd=tmp_path)
    assert searched.returncode == 0, searched.stderr
    (found,) = [row for row in json.loads(looked.stdout)["devices"] if row["device"] == "interferometer"]
    assert found["ok"]
    assert found["simulated"]

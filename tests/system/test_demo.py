"""The demo as a user starts it."""

import json
import time
from pathlib import Path

import pytest

from tests.system.command import catseye


@pytest.mark.slow
def test_demo_does_the_whole_job_within_a_minute(tmp_path: Path) -> None:
    start_s = time.monotonic()
    done = catseye("demo", "--out", tmp_path / "demo", "--json", cwd=tmp_path)
    elapsed_s = time.monotonic() - start_s
    assert done.returncode == 0, done.stderr
    summary = json.loads(done.stdout)
    assert summary["validation"]["ratio"] < 0.25
    assert 0.3 < summary["rms_normalised_error"] < 1.6
    assert summary["fit"]["n_points"] > 1000
    assert summary["fit"]["lack_of_fit"]["significant"]
    assert "left" in done.stderr
    page = Path(summary["report"]).read_text(encoding="utf-8")
    assert page.count("<svg") >= 5
    assert "SIMULATION" in page
    assert Path(summary["run"], "manifest.json").is_file()
    assert elapsed_s < 60.0

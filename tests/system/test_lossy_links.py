"""One answer in twenty is lost, doubled or garbled on every link: the measurement goes on without a person."""

import json
from collections import Counter
from pathlib import Path

from catseye.app.results.runs.summary import summary
from tests.system.lossy import measured
from tests.system.test_ways_of_following import ALL_THETA2, FEW_NODES


def test_a_fault_in_twenty_answers_costs_no_point(tmp_path: Path) -> None:
    edit = {**FEW_NODES, ALL_THETA2: "theta2_deg = [20.0, 40.0]"}
    run = measured(tmp_path, "100", 0.05, 7, "--param", 'reflectors=["P2"]', edit=edit)
    assert len(run.record.rows("points")) == 16 + 2
    assert run.misfit_um < 0.3
    lines = [json.loads(line) for line in (run.record.path / "wire.log").read_text().splitlines()]
    named = Counter(line["device"] for line in lines if line["direction"] == "heal")
    assert named["robot"] > 0
    assert run.record.heals() == named
    assert f"robot {named['robot']}×" in dict(summary(run.record))["links healed"]

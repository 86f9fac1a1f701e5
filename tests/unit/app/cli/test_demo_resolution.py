"""The demonstration of motion resolution on a computer that cannot keep up."""

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest
from typer.testing import CliRunner

from catseye.app.cli import cli
from catseye.app.cli.demonstration import DemoInterruptedError, Demonstration
from catseye.app.cli.resolution import demo
from catseye.app.engine.ending import EndStatus
from catseye.app.engine.request import RunOutcome
from catseye.app.errors import UsageError
from catseye.app.exitcode import ExitCode
from catseye.app.results.resolution.shipped import shipped_results
from catseye.calibration.resolution.errors import MovesError


def test_recordings_that_fell_behind_ask_for_a_lower_speed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def behind(runs: Sequence[object], threshold_percent: float) -> object:
        raise MovesError(
            f"{len(runs)} runs, {threshold_percent:g} %: the largest steps are those of other moves"
        )

    monkeypatch.setattr(demo, "result_of_runs", behind)
    given = Demonstration(tmp_path, 30.0, 1, None, lambda _procedure: print)
    with pytest.raises(UsageError, match=r"those of other moves\. A busy computer .* --speed 10$"):
        demo.evaluate(given, [])


def test_a_single_recording_that_fell_behind_asks_likewise(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    measured = shipped_results("kr210-r2700")[0].model_copy(
        update={"refused": ["backlash test of A1: cut off"]}
    )

    def behind(runs: Sequence[object], threshold_percent: float) -> object:
        del runs, threshold_percent
        return measured

    monkeypatch.setattr(demo, "result_of_runs", behind)
    demo.evaluate(Demonstration(tmp_path, 60.0, 1, None, lambda _procedure: print), [])
    assert "1 of the recordings could not be evaluated. A busy computer" in capsys.readouterr().err


def test_the_demo_measures_before_it_loads_what_fits_and_draws() -> None:
    code = "import sys, catseye.app.cli.resolution.demo; print({'sklearn', 'matplotlib'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"


@pytest.mark.parametrize(("status", "advised"), [("failed", True), ("stopped", False)])
def test_a_run_that_fails_asks_for_a_lower_speed(
    status: EndStatus, advised: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    outcome = RunOutcome(tmp_path / "run", status, ExitCode.REJECTED, "the counter gives 17.0 readings", [])

    async def measure(given: Demonstration) -> list[Path]:
        assert given.speed == 60.0
        raise DemoInterruptedError(outcome)

    monkeypatch.setattr(demo, "measure", measure)
    given = Demonstration(tmp_path, 60.0, 1, None, lambda _procedure: print)
    with pytest.raises(DemoInterruptedError, match=r"the counter gives 17\.0 readings") as ended:
        demo.demonstrate_resolution(given, as_json=False)
    assert str(ended.value).endswith("--speed 20") is advised


@pytest.mark.parametrize(("load", "speed"), [(0.4, 60.0), (3.0, 30.0)])
def test_a_busy_computer_gets_a_slower_bench(
    load: float, speed: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("os.getloadavg", lambda: (load, load, load))
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    begun: list[float] = []

    def begin(given: Demonstration, *, as_json: bool) -> None:
        assert not as_json
        begun.append(given.speed)

    monkeypatch.setattr(demo, "demonstrate_resolution", begin)
    CliRunner().invoke(cli, ["demo", "resolution"])
    assert begun == [speed]

"""The demonstration of six-axis calibration on its emulated bench, with fewer poses and shorter dwells."""

import asyncio
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path

import pytest

from catseye.app.cli.demonstration import Demonstration, emulators, live_cell, run_each
from catseye.app.cli.serial_arm.demo import CELL, Measured, measure, report_of, result_file, validated
from catseye.app.protocol.procedures import load_procedure
from catseye.app.render.page import write_page
from catseye.app.store.reader import RunReader
from tests.system.test_demo_resolution import silent

SHORT = (
    ("tracker-calibration", ("count=38", "dwell_s=0.5", "settle_s=0.3", "nests_every=0")),
    ("tracker-validation", ("count=12", "dwell_s=0.5", "settle_s=0.3", "nests_every=0", "seed=1")),
    ("ballbar", ("step_deg=20", "dwell_s=0.5")),
)


@pytest.fixture(scope="module")
def given(tmp_path_factory: pytest.TempPathFactory) -> Demonstration:
    # Slower than the demonstration of a user: a machine that runs a whole suite is busy.
    return Demonstration(tmp_path_factory.mktemp("six-axis"), 20.0, 0, None, silent)


@pytest.fixture(scope="module")
def measured(given: Demonstration) -> Measured:
    """Return the demonstration, measured once."""
    return asyncio.run(measure(given, SHORT))


@pytest.mark.slow
def test_the_demo_calibrates_an_emulated_arm(measured: Measured, tmp_path: Path) -> None:
    found = validated(measured)
    assert found.frames_only is not None
    before, after = (errors.figures()["mean_mm"] for errors in (found.frames_only, found.calibrated))
    # The paper: 3.168 mm, with frames of its controller, and 0.146 mm at 1000 poses; frames are fitted here.
    assert 0.5 < before < 3.2
    assert after < 0.3

    rows = RunReader(measured.ballbar).rows("ballbar")
    assert {row["nest"] for row in rows} == {"nest1", "nest2"}
    assert all(abs(float(str(row["error_mm"]))) < 1.0 for row in rows)

    page = tmp_path / "report.html"
    write_page(report_of(measured, found), page)
    text = page.read_text(encoding="utf-8")
    assert "SIMULATION" in text
    assert "Errors of length at compensated commands" in text


def no_signals(_: Callable[[int], None]) -> AbstractContextManager[None]:
    return nullcontext()


@pytest.mark.slow
@pytest.mark.usefixtures("measured")
async def test_plateaus_of_the_recording_say_what_is_typed(given: Demonstration, tmp_path: Path) -> None:
    # The arm that was calibrated, since its seed is the same; at places that are read it stands for longer than a
    # busy machine makes it wait on its way.
    again = Demonstration(tmp_path, 5.0, given.seed, None, silent)
    texts = ("nests=['nest1']", "step_deg=30", "dwell_s=8", f"result={result_file(given)}")
    bars = [(load_procedure("ballbar"), (*texts, f"readings={readings}")) for readings in ("typed", "file")]
    async with emulators(again, CELL) as endpoints:
        ports = [endpoints[device] for device in ("robot", "tracker", "control")]
        runs = await run_each(again, live_cell(again.cell_file, CELL, ports), bars, no_signals)
    typed, read = ([row["error_mm"] for row in RunReader(run).rows("ballbar")] for run in runs)
    assert len(typed) == len(read) > 4
    assert read == pytest.approx(typed, abs=0.05)

"""What a run has found, by the kind of the run."""

from typing import cast

import pytest

from catseye.app.results import found
from catseye.app.results.model import Origin, Report, Sign, Statement, section
from catseye.app.store.reader import RunReader
from catseye.calibration.resolution.errors import MovesError

RUN = cast("RunReader", object())
VERDICT = section("verdict", "Verdict", [Statement(Sign.GOOD, "A1: least step")], brief=True)


def recorded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(found, "holds_tests", lambda _run: True)


def test_recorded_steps_show_their_verdict_without_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    recorded(monkeypatch)
    figures = section("figures", "Figures", [Statement(Sign.GOOD, "a picture")])
    report = Report("A1", Origin("", ""), (VERDICT, figures))
    monkeypatch.setattr(found, "resolution_run_report", lambda _run: report)
    assert found.found_sections(RUN) == [VERDICT]


def test_recordings_that_do_not_fit_say_why(monkeypatch: pytest.MonkeyPatch) -> None:
    recorded(monkeypatch)

    def refused(run: object) -> Report:
        raise MovesError(f"{run}: the recording is cut off")

    monkeypatch.setattr(found, "resolution_run_report", refused)
    ((said,),) = (one.blocks for one in found.found_sections(RUN))
    assert isinstance(said, Statement)
    assert (said.sign, "the recording is cut off" in said.text) == (Sign.BAD, True)


def test_another_run_is_asked_by_its_arm(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(found, "holds_tests", lambda _run: False)
    monkeypatch.setattr(found, "serial_sections", lambda _run: [])
    monkeypatch.setattr(found, "scara_sections", lambda _run: [VERDICT])
    assert found.found_sections(RUN) == [VERDICT]


def test_a_run_that_nothing_else_knows_says_its_own_result(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(found, "holds_tests", lambda _run: False)
    for known in ("serial_sections", "scara_sections"):
        monkeypatch.setattr(found, known, lambda _run: [])
    monkeypatch.setattr(found, "declared_sections", lambda _run: [VERDICT])
    assert found.found_sections(RUN) == [VERDICT]

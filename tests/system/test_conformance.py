"""Every driver of ours passes the conformance suite that third parties are given, on our emulators."""

from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any

import pytest

from app.testing.candidate import Candidate, candidate_of
from app.testing.checks.catalogue import ALL, applicable
from app.testing.checks.check import Check, run_check
from drivers.registry import driver_names
from simulators.config import Option
from tests.system.quick import short_timeouts

_OPTIONS: dict[str, dict[str, Option]] = {"attocube-ids": {"start_time_s": 0.05}}
"""Emulators whose warming up would take longer than the check."""


def candidates() -> list[Candidate]:
    """Return our drivers that have an emulator and a kind."""
    found = []
    for name in driver_names():
        try:
            found.append(candidate_of(name))
        except LookupError:
            continue
    return found


def test_no_driver_with_an_emulator_is_left_out() -> None:
    names = {candidate.name for candidate in candidates()}
    assert {"melfa-r3", "line-counter", "modbus-air", "lasertex-hpi", "bench-tracker"} <= names


def groups() -> list[Any]:
    """Return drivers with their checks, by the module of the checks."""
    return [
        pytest.param(candidate, list(checks), id=f"{candidate.name}-{module.rpartition('.')[2]}")
        for candidate in candidates()
        for module, checks in groupby(applicable(candidate), key=lambda check: check.body.__module__)
    ]


@pytest.mark.parametrize(("candidate", "checks"), groups())
def test_conforms(candidate: Candidate, checks: list[Check], tmp_path: Path) -> None:
    settings = short_timeouts(candidate, tmp_path)
    examined = replace(candidate, settings=settings, options=_OPTIONS.get(candidate.name, {}))
    for check in checks:
        run_check(check, examined)


def test_every_check_has_a_name_of_its_own_within_a_kind_and_says_what_it_asks() -> None:
    for kind in ("robot", "interferometer", "environment", "tracker"):
        names = [check.name for check in ALL if kind in check.kinds]
        assert len(names) == len(set(names))
    assert all((check.body.__doc__ or "").endswith(".") for check in ALL)

"""Every driver of ours passes the conformance suite that third parties are given, on our emulators."""

from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any

import pytest

from app.testing.candidate import KINDS, Candidate, candidate_of
from app.testing.checks.catalogue import ALL, applicable
from app.testing.checks.check import Check, run_check
from drivers.registry import driver_names
from simulators.config import Option
from tests.system.quick import short_timeouts

_OPTIONS: dict[str, dict[str, Option]] = {"attocube-ids": {"start_time_s": 0.0}}
"""Emulators whose warming up would take longer than the check."""


def candidates() -> list[Candidate]:
    """Return all our drivers; each has an emulator and is of a known kind."""
    return [candidate_of(name) for name in driver_names()]


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
    for kind in KINDS:
        names = [check.name for check in ALL if kind in check.kinds]
        assert len(names) == len(set(names))
    assert all((check.body.__doc__ or "").endswith(".") for check in ALL)

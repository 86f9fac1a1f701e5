"""Every driver of ours passes the conformance suite that third parties are given, on our emulators."""

import gc
import multiprocessing
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from itertools import groupby
from multiprocessing.pool import AsyncResult
from pathlib import Path
from typing import Any

import pytest

from catseye.app.testing.candidate import Candidate, candidate_of
from catseye.app.testing.checks import identity
from catseye.app.testing.checks.catalogue import ALL, applicable
from catseye.app.testing.checks.check import Check, run_check
from catseye.app.testing.trial import NotApplicableError
from catseye.drivers.roles.device import ROLES
from catseye.drivers.roles.registry import driver_names
from catseye.simulators.config import Option
from tests.left_behind import nothing_left, warnings_fail
from tests.patience import HANG_S
from tests.system.other_devices import OTHERS, inapplicable
from tests.system.quick import short_timeouts

AT_A_TIME = 3

_OPTIONS: dict[str, dict[str, Option]] = {"attocube-ids": {"start_time_s": 0.0}}
"""Emulators whose warming up would take longer than the check."""


_ELSEWHERE = {"file": f"file://{tempfile.gettempdir()}/catseye-readings.csv"}
"""Drivers that nothing emulates, with what they are to talk to: here a file that nobody has written yet."""


def candidate(name: str) -> Candidate:
    """Return a driver of ours in front of its emulator, if it has one."""
    return candidate_of(name, endpoint=_ELSEWHERE.get(name))


def candidates() -> list[Candidate]:
    """Return all our drivers; each is of a known kind."""
    return [candidate(name) for name in driver_names()]


def groups() -> list[Any]:
    """Return names of drivers and of the modules of their checks."""
    return [
        pytest.param(driver.name, module, id=f"{driver.name}-{module.rpartition('.')[2]}")
        for driver in candidates()
        for module, _ in groupby(applicable(driver), key=lambda check: check.body.__module__)
    ]


def examine(name: str, module: str) -> set[str]:
    """Run a module's checks of a driver, in a process that no fixture looks at; return what did not apply."""
    driver = candidate(name)
    # As the engine does before a run: a pass over all that was imported takes longer than a cycle of set points.
    gc.collect()
    gc.freeze()
    with tempfile.TemporaryDirectory() as folder, nothing_left(), warnings_fail():
        settings = short_timeouts(driver, Path(folder))
        examined = replace(driver, settings=settings, options=_OPTIONS.get(name, {}), **OTHERS.get(name, {}))
        checks = [check for check in applicable(driver) if check.body.__module__ == module]
        return {check.name for check in checks if not applies(check, examined)}


def applies(check: Check, driver: Candidate) -> bool:
    """Run a check; return whether the emulator shows what it looks for."""
    try:
        run_check(check, driver)
    except NotApplicableError:
        return False
    return True


@pytest.fixture(scope="module")
def examined(request: pytest.FixtureRequest) -> Iterator[dict[tuple[str, str], "AsyncResult[set[str]]"]]:
    """Examine whatever drivers have been asked for, several at a time: most of it is waiting for time-outs."""
    chosen = [getattr(item, "callspec", None) for item in request.session.items if item.path == request.path]
    asked = [(str(one.params["name"]), str(one.params["module"])) for one in chosen if one is not None]
    with multiprocessing.get_context("forkserver").Pool(AT_A_TIME) as pool:
        yield {one: pool.apply_async(examine, one) for one in asked}
        pool.close()
        pool.join()


@pytest.mark.parametrize(("name", "module"), groups())
def test_conforms(name: str, module: str, examined: dict[tuple[str, str], "AsyncResult[set[str]]"]) -> None:
    left_out = inapplicable(candidate(name)) if module == identity.__name__ else set()
    assert examined[name, module].get(HANG_S) == left_out


def test_checks_are_documented_and_uniquely_named_within_a_role() -> None:
    for role in ROLES:
        names = [check.name for check in ALL if role in check.roles]
        assert len(names) == len(set(names))
    assert all((check.body.__doc__ or "").endswith(".") for check in ALL)

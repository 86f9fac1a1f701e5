"""Named places where the process dies on request."""

import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from catseye.app.errors import UsageError
from catseye.app.files import crash_points
from catseye.app.files.crash_points import POINTS, VARIABLE, arm, crash_point

ROOT = Path(crash_points.__file__).parents[2]


@pytest.fixture(autouse=True)
def disarmed() -> Iterator[None]:
    yield
    arm({})


@pytest.fixture
def deaths(monkeypatch: pytest.MonkeyPatch) -> list[tuple[int, int]]:
    found: list[tuple[int, int]] = []
    monkeypatch.setattr(os, "kill", lambda pid, number: found.append((pid, number)))
    return found


def test_a_process_dies_at_the_pass_that_was_asked_for(deaths: list[tuple[int, int]]) -> None:
    arm({VARIABLE: "after-commit:3"})
    for _ in range(2):
        crash_point("after-commit")
        crash_point("before-commit")
    assert deaths == []
    crash_point("after-commit")
    assert deaths == [(os.getpid(), signal.SIGKILL)]


def test_without_a_number_the_first_pass_counts(deaths: list[tuple[int, int]]) -> None:
    arm({VARIABLE: "zeroed"})
    crash_point("zeroed")
    assert len(deaths) == 1


@pytest.mark.parametrize("environment", [{}, {VARIABLE: ""}])
def test_nothing_dies_unasked(environment: dict[str, str], deaths: list[tuple[int, int]]) -> None:
    arm(environment)
    for name in POINTS:
        crash_point(name)
    assert deaths == []


@pytest.mark.parametrize("wanted", ["nowhere", "after-commit:0", "after-commit:x", "after-commit:-1"])
def test_an_unknown_place_is_refused_with_the_known_ones(wanted: str) -> None:
    with pytest.raises(UsageError) as refused:
        arm({VARIABLE: wanted})
    assert all(name in str(refused.value) for name in POINTS)


def test_every_name_stands_at_exactly_one_place() -> None:
    source = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "app").rglob("*.py"))
    assert {name: source.count(f'crash_point("{name}")') for name in POINTS} == dict.fromkeys(POINTS, 1)

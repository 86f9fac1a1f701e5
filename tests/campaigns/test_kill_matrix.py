"""Measurements that are killed and go on: at 50 random moments, at every named place, in the paper's whole plan."""

import json
import math
import random
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from catseye.app.files.crash_points import RUN_POINTS
from catseye.app.store.reader import RunReader
from catseye.app.store.seal import read_manifest
from catseye.app.store.verify import verify
from tests.system.command import Emulated, catseye, emulated
from tests.system.interruptions import Moment, Process, Story, commands, differences_mm

KILLS = 50
SEED = 20261121
MOST_LIVES = 4

NODES = {
    "theta1_deg = [-140.0, -120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0]": (
        "theta1_deg = [-70.0, -40.0, -10.0]"
    ),
    "theta2_deg = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0]": "theta2_deg = [40.0, 65.0, 90.0]",
}
"""The smallest plan with three reflectors whose maps can be identified with room to spare."""

ELSEWHERE = {"chunk-stored"}
"""Distances are no recording; test_kill_procedures has some."""

KILLED = -signal.SIGKILL
SAME_MM = 2e-6
"""Of distances on a bench without measuring errors: the counter shows nanometres, and two of them are subtracted."""

SAME_MAP = 0.01
"""Of maps on that bench, in units of their combined standard uncertainty.

The arm's own errors let the aim miss a little, which leaves residuals of 0.06 µm rms (10 µm are stated); the dead
path that an interruption adds takes another share of them.
"""

WORST_NORMALISED = 4.0
"""Of differences between two identified maps in units of their combined standard uncertainty."""


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Emulated]:
    with emulated(tmp_path, edit=NODES) as running:
        search(running)
        yield running


@pytest.fixture
def quiet_bench(tmp_path: Path) -> Iterator[Emulated]:
    with emulated(tmp_path, edit=NODES, module="tests.system.quiet_bench") as running:
        search(running)
        yield running


def search(bench: Emulated) -> None:
    found = catseye("run", "reflector-search", "--cell", bench.cell, "--speed", "400", cwd=bench.cell.parent)
    assert found.returncode == 0, found.stderr


def uninterrupted(bench: Emulated) -> tuple[Story, Process]:
    story = Story(bench)
    life = story.live()
    assert life.returncode == 0, life.stderr
    return story, life


def until_complete(story: Story) -> None:
    """Go on until the run is complete."""
    for _ in range(MOST_LIVES):
        if story.path is not None and read_manifest(story.path) is not None:
            return
        life = story.live()
        if life.returncode == 0:
            return
    raise AssertionError(f"the run does not come to its end: {story.lives[-1].stderr}")


def require_whole(story: Story, reference: RunReader) -> None:
    """Check that the record is complete and sound and that each command was measured exactly once."""
    assert story.reader.status == "complete"
    assert verify(story.reader.path).ok
    assert sorted(commands(story.reader)) == sorted(commands(reference))


def identified(reader: RunReader, folder: Path) -> dict[str, Any]:
    output = folder / f"{reader.path.name}.json"
    done = catseye("identify", str(reader.path), "-o", output, cwd=folder)
    assert done.returncode == 0, done.stderr
    result: dict[str, Any] = json.loads(output.read_text(encoding="utf-8"))
    return result


def estimates(result: dict[str, Any]) -> list[tuple[float, float]]:
    """Return links (mm) and maps (mdeg) with their standard uncertainties."""
    found = [(result[name]["value"], result[name]["u"]) for name in ("link1_mm", "link2_mm")]
    for name in ("theta1_map", "theta2_map"):
        table = result[name]
        for side in ("positive", "negative"):
            found += zip(table[f"{side}_mdeg"], table[f"u_{side}_mdeg"], strict=True)
    return found


def worst_normalised(one: dict[str, Any], other: dict[str, Any]) -> float:
    """Return the largest difference of two results in units of its standard uncertainty."""
    return max(
        abs(a - b) / math.hypot(u_a, u_b)
        for (a, u_a), (b, u_b) in zip(estimates(one), estimates(other), strict=True)
        if u_a > 0.0
    )


def report(text: str) -> None:
    print(f"\n{text}", flush=True)  # noqa: T201  # the figure


@pytest.mark.timeout(3600)
def test_killed_at_random_moments_with_every_error_of_the_bench(bench: Emulated, tmp_path: Path) -> None:
    reference, life = uninterrupted(bench)
    expected = identified(reference.reader, tmp_path)
    moments = random.Random(SEED)
    worst, points, kills = 0.0, 0, 0
    while kills < KILLS:
        story = Story(bench)
        kills += story.live(moment=Moment.drawn(moments, life.events)).returncode == KILLED
        until_complete(story)
        require_whole(story, reference.reader)
        points += len(story.lives[0].points)
        worst = max(worst, worst_normalised(identified(story.reader, tmp_path), expected))
    report(
        f"{KILLS} kills at random (seed {SEED}), {points} points reported before them, all stored; every command was "
        f"measured once; maps differ from the uninterrupted run's by at most {worst:.2f} of their combined standard "
        "uncertainties"
    )
    assert worst < WORST_NORMALISED


@pytest.mark.timeout(3600)
def test_killed_at_every_named_place_on_a_bench_without_errors(quiet_bench: Emulated, tmp_path: Path) -> None:
    reference, _ = uninterrupted(quiet_bench)
    expected = identified(reference.reader, tmp_path)
    moments = random.Random(SEED)
    worst_mm = worst = 0.0
    places = [name for name in RUN_POINTS if name not in ELSEWHERE]
    for name in places:
        story = Story(quiet_bench)
        if name in {"unsealed", "reopened", "prompt-open"}:
            # These lie on the way back into a run.
            assert story.live(crash=f"after-commit:{moments.randint(2, 60)}").returncode == KILLED
        often = name in {"before-motion", "after-motion", "before-commit", "after-commit"}
        crash = f"{name}:{moments.randint(2, 60)}" if often else name
        assert story.live(crash=crash).returncode == KILLED, crash
        if name != "sealed":
            until_complete(story)
        require_whole(story, reference.reader)
        worst_mm = max(worst_mm, *map(abs, differences_mm(story.reader, reference.reader)))
        worst = max(worst, worst_normalised(identified(story.reader, tmp_path), expected))
    report(
        f"{len(places)} named places: distances differ from the uninterrupted run's by at most {worst_mm:.1e} mm, "
        f"maps by {worst:.1e} of their combined standard uncertainties"
    )
    assert worst_mm <= SAME_MM
    assert worst < SAME_MAP


@pytest.mark.timeout(3600)
def test_the_papers_plan_killed_in_the_middle(tmp_path: Path) -> None:
    with emulated(tmp_path) as whole:
        search(whole)
        reference, life = uninterrupted(whole)
        story = Story(whole)
        killed = story.live(moment=Moment(life.events // 2, 0.0))
        assert killed.returncode == KILLED
        assert 100 < len(killed.points) < 1000
        until_complete(story)
        require_whole(story, reference.reader)
        first, second = (identified(one.reader, tmp_path) for one in (reference, story))
        shown = catseye("show", str(story.path), cwd=tmp_path)
    worst = worst_normalised(first, second)
    report(
        f"{shown.stdout}\nthe paper's plan killed after {len(killed.points)} points: maps differ from the "
        f"uninterrupted run's by at most {worst:.2f} combined standard uncertainties"
    )
    assert worst < WORST_NORMALISED
    assert "DIED" in shown.stdout
    assert "RESUMED" in shown.stdout

"""A run that is killed, at any moment and at every named place, goes on to the same result."""

import json
import random
import signal
from collections.abc import Iterator

import pytest

from catseye.app.files.crash_points import RUN_POINTS
from catseye.app.store.reader import RunReader
from catseye.app.store.seal import read_manifest
from catseye.app.store.verify import verify
from tests.system.command import Emulated, catseye, emulated, only
from tests.system.interruptions import Moment, Story, commands, differences_mm

SEED = 20261121
SMALL = {
    "theta1_deg = [-140.0, -120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0]": (
        "theta1_deg = [-60.0, -30.0]"
    ),
    "theta2_deg = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0]": "theta2_deg = [40.0, 70.0]",
    **only("P1"),
}
"""Four nodes and one reflector."""

KILLED = -signal.SIGKILL
SAME_MM = 2e-6
"""Of distances on a bench without measuring errors: the counter shows nanometres, and two of them are subtracted."""


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    folder = tmp_path_factory.mktemp("resume")
    with emulated(folder, edit=SMALL, module="tests.system.quiet_bench") as running:
        searched = catseye("run", "reflector-search", "--cell", running.cell, "--speed", "400", cwd=folder)
        assert searched.returncode == 0, searched.stderr
        yield running


@pytest.fixture(scope="module")
def uninterrupted(bench: Emulated) -> Story:
    story = Story(bench)
    life = story.live()
    assert life.returncode == 0, life.stderr
    return story


@pytest.fixture(scope="module")
def reference(uninterrupted: Story) -> RunReader:
    """Return the same measurement without an interruption."""
    return uninterrupted.reader


def require_same(story: Story, reference: RunReader) -> None:
    assert story.reader.status == "complete"
    assert verify(story.reader.path).ok
    assert read_manifest(story.reader.path) is not None
    assert sorted(commands(story.reader)) == sorted(commands(reference))
    assert max(map(abs, differences_mm(story.reader, reference))) <= SAME_MM


def test_a_run_killed_at_any_crash_point_resumes_identically(bench: Emulated, reference: RunReader) -> None:
    story = Story(bench)
    at_the_end = ["before-closing", "closed", "before-manifest"]
    begun_anew = ["directory-made", "sealed"]
    # Distances are no recording; tests.unit.app.store.test_chunks has one that dies.
    elsewhere = ["chunk-stored"]
    on_the_way = [
        name for name in RUN_POINTS if name not in {"run-opened", *at_the_end, *begun_anew, *elsewhere}
    ]
    for name in ("run-opened", *on_the_way, *at_the_end):
        assert story.live(crash=name).returncode == KILLED, name
    last = story.live()
    assert last.returncode == 0, last.stderr
    assert "its manifest is written now" in last.stderr
    require_same(story, reference)


def test_a_run_killed_at_random_moments_resumes_identically(bench: Emulated, uninterrupted: Story) -> None:
    moments, story = random.Random(SEED), Story(bench)
    for _ in range(4):
        # A quarter of a life each, so that the last one has something left to do.
        moment = Moment.drawn(moments, uninterrupted.lives[0].events // 4)
        assert story.live(moment=moment).returncode == KILLED, f"seed {SEED}, {moment}"
    last = story.live()
    assert last.returncode == 0, last.stderr
    require_same(story, uninterrupted.reader)


def test_runs_killed_undescribed_or_sealed_are_absent_or_complete(
    bench: Emulated, reference: RunReader
) -> None:
    story = Story(bench)
    assert story.live(crash="directory-made").returncode == KILLED
    assert story.path is None
    assert story.live(crash="sealed").returncode == KILLED
    require_same(story, reference)
    refused = catseye("resume", str(story.path), cwd=story.folder)
    assert refused.returncode == 2
    assert "complete" in refused.stderr


def test_an_aborted_run_resumes_after_the_operator_clears_it(bench: Emulated, uninterrupted: Story) -> None:
    story, reference = Story(bench), uninterrupted.reader
    halfway = Moment(uninterrupted.lives[0].events // 2, 0.0)
    assert story.live(moment=halfway, number=signal.SIGTERM).returncode == 143
    assert story.reader.status == "aborted"
    assert read_manifest(story.reader.path) is not None
    rehearsed = catseye("resume", str(story.path), "--dry-run", "--json", cwd=story.folder)
    steps = {step["step"] for step in json.loads(rehearsed.stdout)["steps"]}
    done = {step.step_id for step in story.reader.steps()}
    assert done
    assert steps == {step.step_id for step in reference.steps()} - done
    # It loses its manifest to go on; a process that dies there leaves it to the next one.
    assert story.live(crash="unsealed").returncode == KILLED
    last = story.live()
    assert last.returncode == 0, last.stderr
    require_same(story, reference)
    answered = {prompt["id"]: (prompt["answer"], prompt["who"]) for prompt in story.reader.prompts()}
    assert answered["clear"] == ("yes", "emulated operator")
    assert answered["resume/reflectors"] == ("untouched", "emulated operator")
    states = [event.data["state"] for event in story.reader.events() if event.kind == "state"]
    aborted = states.index("ABORTED")
    assert states[aborted + 1 :] == ["CLEARING", "STOPPED", "STARTING", "EXECUTE", "COMPLETE"]

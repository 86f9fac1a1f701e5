"""Short runs of every procedure that are killed again and again, and go on to their end."""

import random
import signal
from collections import Counter
from dataclasses import dataclass, field
from typing import Final

from catseye.app.exitcode import ExitCode
from catseye.app.files.crash_points import RUN_POINTS
from catseye.app.store.reader import RunReader
from catseye.app.store.seal import read_manifest
from catseye.app.store.verify import verify
from catseye.procedures.kit.records import OBSERVATIONS
from tests.system.command import Emulated
from tests.system.interruptions import Moment, Story
from tests.system.trials import Trial

KILLED: Final = -signal.SIGKILL
MOST_KILLS: Final = 6
"""Of one run; then it goes on to its end, and the next run begins."""

MOST_LIVES: Final = 4
STARVED: Final = {ExitCode.DEVICE, ExitCode.SAFETY}
"""How a run ends whose program gets no time on a busy machine: a device seems silent, or the guard stops the arm."""

RETURNING: Final = ("unsealed", "reopened")
ENDING: Final = ("before-closing", "closed", "before-manifest")


@dataclass
class Kills:
    """What was killed and what it had reported.

    Attributes:
        count: how often a process died.
        runs: how many runs came to their end.
        points: how many points the processes that died had reported as stored.
        steps: how many steps they had reported as done.
        places: how often a process died at each named place.
    """

    count: int = 0
    runs: int = 0
    points: int = 0
    steps: int = 0
    places: Counter[str] = field(default_factory=Counter)

    def note(self, story: Story, place: str = "") -> bool:
        """Count the last life of a run, if it was killed; return whether it was."""
        life = story.lives[-1]
        assert life.returncode in {KILLED, 0, *STARVED}, life.stderr
        if life.returncode != KILLED:
            return False
        self.count += 1
        self.points += len(life.points)
        self.steps += len(life.steps)
        self.places[place] += bool(place)
        return True


@dataclass(frozen=True)
class Reference:
    """A run that nothing interrupted.

    Attributes:
        events: how many it published.
        steps: its steps, by name.
        tables: how many rows each of its tables has.
    """

    events: int
    steps: frozenset[str]
    tables: dict[str, int]

    @classmethod
    def of(cls, trial: Trial, bench: Emulated) -> "Reference":
        """Run it to its end."""
        story = trial.story(bench)
        life = story.live()
        assert life.returncode == 0, life.stderr
        return cls(life.events, *_extent(story.reader))


def killed_at_random(
    trial: Trial, bench: Emulated, reference: Reference, rng: random.Random, kills: int
) -> Kills:
    """Kill runs at random moments, each several times, until so many processes have died."""
    done = Kills()
    while done.count < kills:
        story = trial.story(bench)
        for number in range(min(MOST_KILLS, kills - done.count)):
            # Each life has less left to do.
            story.live(moment=Moment.drawn(rng, max(2, reference.events // (1 + number))))
            if not done.note(story) or _is_sealed(story):
                break
        to_its_end(trial, story, reference)
        done.runs += 1
    return done


def killed_at_every_place(trial: Trial, bench: Emulated, reference: Reference, rng: random.Random) -> Kills:
    """Kill runs at every named place that they pass."""
    done = Kills()
    story = trial.story(bench)
    for place in (
        *(each for each in RUN_POINTS if each not in {*RETURNING, *ENDING, "sealed"}),
        *RETURNING,
        *ENDING,
    ):
        if place in RETURNING and story.path is None:
            assert story.live(crash="before-closing").returncode == KILLED
        often = rng.randint(1, 3) if place in {"before-motion", "after-motion", "after-commit"} else 1
        story.live(crash=f"{place}:{often}")
        if not done.note(story, place):
            to_its_end(trial, story, reference)
            done.runs, story = done.runs + 1, trial.story(bench)
    to_its_end(trial, story, reference)
    story = trial.story(bench)
    story.live(crash="sealed")
    assert done.note(story, "sealed")
    to_its_end(trial, story, reference)
    done.runs += 2
    return done


def to_its_end(trial: Trial, story: Story, reference: Reference) -> None:
    """Go on until the run is complete; it is sound, sealed, and has done what the reference has."""
    for _ in range(MOST_LIVES):
        if _is_sealed(story) and story.reader.status == "complete":
            break
        story.live()
    assert _is_sealed(story), story.lives[-1].stderr
    assert story.reader.status == "complete", story.lives[-1].stderr
    assert verify(story.reader.path).ok
    if trial.fixed:
        steps, tables = _extent(story.reader)
        # One that was interrupted may have set something up once more.
        assert reference.steps <= steps, sorted(reference.steps - steps)
        assert tables == reference.tables


def _is_sealed(story: Story) -> bool:
    return story.path is not None and read_manifest(story.path) is not None


def _extent(reader: RunReader) -> tuple[frozenset[str], dict[str, int]]:
    steps = frozenset(step.step_id for step in reader.steps() if not step.step_id.startswith("nests/"))
    # A run that was interrupted zeroes and loses the beam, and measures its fixed nests, at other moments.
    names = [table.name for table in reader.tables() if table.name not in {OBSERVATIONS.name, "nests"}]
    return steps, {name: reader.count(name) for name in names}

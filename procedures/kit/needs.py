"""What a procedure declares that it needs of a cell, beyond a plan that can be made."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol

from catseye.drivers.roles.device import Role
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.tasks import OpticsKind

TrackerAbility = Literal["points", "poses", "two_faces"]
"""One of `catseye.drivers.roles.tracker.TrackerAbilities`, by its name."""


@dataclass(frozen=True)
class After:
    """A procedure that should have been run before: advised, never required.

    Attributes:
        procedure: which.
        what: it gives, in one or two words: levelling, alignment, warm arm.
        fresh_for_s: it counts for so long; None for ever.
    """

    procedure: str
    what: str
    fresh_for_s: float | None = None


# Each system has a bench of its own type.
@dataclass(frozen=True)
class Equipment:
    """Something of the bench that a procedure uses.

    Attributes:
        what: it is, in one or two words.
        found: returns what the bench has of it, in words; empty where it has none.
        without: what becomes of a run without it, in words.
    """

    what: str
    found: Callable[[Any], str]
    without: str = ""


class EarlierRun(Protocol):
    """A stored run, as far as a later one builds on it."""

    @property
    def name(self) -> str: ...  # noqa: D102  # of the run
    @property
    def meta(self) -> Row: ...  # noqa: D102  # what it says about itself

    def result(self, step_id: str) -> Row | None:
        """Return the last result of a step; None when it was not done."""
        ...

    def data_of(self, kind: str) -> Sequence[Row]:
        """Return the data of all events of a kind, in order."""
        ...

    def answers(self) -> Mapping[str, str | None]:
        """Return the last answer to each question by its id; None for one that stayed without."""
        ...


@dataclass(frozen=True)
class Basis:
    """An earlier run that a plan is made from: a search, at whose places a measurement aims.

    Attributes:
        procedure: that makes such runs.
        what: it gives, in one or two words.
        without: what a plan is made from where there is none, in words.
        found: returns what a run found, as `System.aimed` takes it; None when it found nothing.
        missing: what a run is that found nothing, and what to do about it.
        fits: returns whether a run belongs to a bench as its cell file has it.
        misfit: what a run that does not fit did, and what to do about it.
        overtaken_by: procedures after which what was found may not hold any more.
        overtakes: returns whether a run of one of them has changed it.
        overtaken: what that run did to an earlier one, whose name stands for `{run}`, and what to do about it.
    """

    procedure: str
    what: str
    without: str
    found: Callable[[EarlierRun], Row | None]
    missing: str
    fits: Callable[[Any, EarlierRun], bool]
    misfit: str
    overtaken_by: tuple[str, ...]
    overtakes: Callable[[EarlierRun], bool]
    overtaken: str


@dataclass(frozen=True)
class Aftermath:
    """What earlier runs may have left a bench like: whoever does not know it looks for the wrong cause of a failure.

    Attributes:
        procedure: that may leave it so.
        left: returns what a run has left and when that matters, to follow the run's name; empty for nothing.
        settled_by: procedure whose complete run later shows that it does not matter any more.
    """

    procedure: str
    left: Callable[[EarlierRun], str]
    settled_by: str


@dataclass(frozen=True)
class Needs:
    """What a procedure needs.

    Attributes:
        bench: kind of bench that it is planned on.
        roles: of the devices that it uses beside the robot.
        tracker: what the tracker's driver has to be able to do, one of these; empty where it is not asked for more.
        optics: that stand beside the arm; the cell file describes them.
        equipment: of the bench.
        after: procedures that should have been run.
        basis: earlier run that the plan is made from; None for none.
        aftermath: of earlier runs, said at the start and with a failure; None for none.
    """

    bench: type[Bench] = Bench
    roles: tuple[Role, ...] = ()
    tracker: tuple[TrackerAbility, ...] = ()
    optics: tuple[OpticsKind, ...] = ()
    equipment: tuple[Equipment, ...] = ()
    after: tuple[After, ...] = ()
    basis: Basis | None = None
    aftermath: Aftermath | None = None

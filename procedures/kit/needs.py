"""What a procedure declares that it needs of a cell, beyond a plan that can be made."""

from dataclasses import dataclass

from catseye.procedures.kit.bench import Bench


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


@dataclass(frozen=True)
class Needs:
    """What a procedure needs.

    Attributes:
        bench: kind of bench that it is planned on.
        after: procedures that should have been run.
        aim: it is planned with the places that a search found.
        tracker: its result is better with an independent instrument.
    """

    bench: type[Bench] = Bench
    after: tuple[After, ...] = ()
    aim: bool = False
    tracker: bool = False

"""A procedure: what happens on a bench, and everything that the application knows of it."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, cast

from pydantic import BaseModel

from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.event_text import EventTexts
from catseye.procedures.kit.explanation import Explanation
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.questions import Question
from catseye.procedures.kit.records import Record

LivePlots = Literal["steps", "record"]


@dataclass(frozen=True)
class Stage:
    """A place on the way from an unknown bench to a validated result.

    Attributes:
        order: places are sorted by it; steps of ten leave room for others.
        purpose: what it is for.
        way: which way: a cell is led along those for which it has what they need.
        since: procedure without whose run, or before which, a run does not count; empty for none.
        renewed_by: procedure whose later run makes another one necessary; empty for none.
        fresh_for_s: a run counts for so long; None for ever.
        covered_by: procedure whose run makes it superfluous; empty for none.
        covered: how to say so.
        optional: the way leads on without it.
    """

    order: int
    purpose: str
    way: str = ""
    since: str = ""
    renewed_by: str = ""
    fresh_for_s: float | None = None
    covered_by: str = ""
    covered: str = ""
    optional: bool = False


@dataclass(frozen=True)
class Asked:
    """Something that a command takes and only a person knows.

    Attributes:
        name: of the placeholder that stands for it among the command's words.
        what: it is, as a question has it.
        hint: what it may be.
    """

    name: str
    what: str
    hint: str


@dataclass(frozen=True)
class Analysis:
    """A command of the program that works on a run of a procedure.

    Attributes:
        command: its name.
        gives: what comes out, for whoever has just made the run; empty where it takes more than the run.
        stage: its place on the way.
        writes_result: it writes a result file of the run.
        usage: the words after its name, with placeholders: `{run}` is the id of the run, `{result}` as a whole word
            the results that the way has led to so far, `{runs}` as a whole word the option that names the folder of
            runs where it is not the usual one, `{folder}` where what it writes belongs, `{cell}` the cell
            file, `{name}` the name of that file without its ending, `{arm}` the arm of its robot; and the names of
            what it asks.
        writes: name of another file that it writes: one that is newer than the results says that it is done.
        asks: what a person has to give.
        called: name of the stage where it is not that of the command.
        stands_beside: it writes a model of the run that its result is held against.
        changes_cell: it writes what the run has found into the cell file, with the name of the run.
        joins: it takes all that the way has given: what it writes has to be newer than every run, too.
    """

    command: str
    gives: str
    stage: Stage
    writes_result: bool
    usage: tuple[str, ...]
    writes: str = ""
    asks: tuple[Asked, ...] = ()
    called: str = ""
    stands_beside: bool = False
    changes_cell: bool = False
    joins: bool = False


class Procedure(ABC):
    """Base of procedures; one registers its class under the entry point group `catseye.procedures`.

    Whoever lists procedures or reads their runs imports the module of the class: what needs scipy is imported where
    it is used.

    Attributes:
        name: as on the command line.
        title: one line for people.
        explanation: the same in a paragraph and a sketch of the set-up.
        params_type: what may be chosen.
        needs: of a cell.
        stage: its place on the way; None for none.
        records: types of what it records.
        analyses: commands that work on its runs, the most sensible first.
        event_texts: of its own events.
        questions: that it may ask, beside those of the engine.
        sets_up_anew: what somebody has moved before a run is resumed is set up anew where it is still needed; without
            it, such a run cannot go on.
        live_plots: what is plotted while it runs: the staircase and the errors of steps, or the figures of the
            report from what is stored so far.
        demo: parameters of its run in the demonstration, as on the command line; None where it has none.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    explanation: ClassVar[Explanation] = Explanation()
    params_type: ClassVar[type[BaseModel]]
    needs: ClassVar[Needs] = Needs()
    stage: ClassVar[Stage | None] = None
    records: ClassVar[tuple[type[Record], ...]] = ()
    analyses: ClassVar[tuple[Analysis, ...]] = ()
    event_texts: ClassVar[EventTexts] = {}
    questions: ClassVar[tuple[Question, ...]] = ()
    sets_up_anew: ClassVar[bool] = False
    live_plots: ClassVar[LivePlots] = "record"
    demo: ClassVar[tuple[str, ...] | None] = None

    # Each procedure has a bench, parameters and a plan of types of its own.
    @abstractmethod
    def plan(self, bench: Any, params: Any) -> Any:
        """Plan everything before anything moves; pure.

        Raises:
            PlanError: the plan cannot be made; the text says why and what to do.
        """

    def equipped(self, bench: Any, params: Any) -> Bench:
        """Return the bench as a run finds and makes it: every motion is checked against its bodies."""
        del params
        return cast("Bench", bench)

    @abstractmethod
    async def run(self, ctx: Context, plan: Any) -> None:
        """Carry the plan out, step by step."""

    async def teardown(self, ctx: Context) -> None:  # noqa: B027  # most leave the arm where it stands
        """Leave the bench as it should be; the robot cannot be moved after a stop."""

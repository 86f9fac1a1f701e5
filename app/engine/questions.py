"""What the engine asks in every run, whatever its procedure."""

from typing import Final

from catseye.procedures.kit.questions import Question

OVERRIDE: Final = Question(
    "override",
    "confirm",
    "the speed override is 0 %: nobody is in the arm's way and it may be set to the cell's",
    "override",
    motion=True,
)

WALK_WAIVER: Final = Question(
    "walk/waiver",
    "text",
    "a reason why paths that were not walked through may be driven at full speed, or no",
    "walk/waiver",
    motion=True,
    rests_after=("no",),
)

ACKNOWLEDGE: Final = Question(
    "acknowledge/<number>",
    "confirm",
    "the robot was stopped: nobody is in its way and everything is in its place",
    "acknowledge/1",
    motion=True,
)

CLEAR: Final = Question(
    "clear",
    "confirm",
    "the cause of an abort is found and removed; when a run is resumed",
    "clear",
    motion=True,
)

REFLECTORS: Final = Question(
    "resume/reflectors",
    "choice",
    "reflectors, nests and instrument are untouched since a run was interrupted; when it is resumed",
    "resume/reflectors",
    choices=("untouched", "moved"),
    motion=True,
    # After "untouched" the run drives on at once, after "moved" never, or not without another question.
    rests_after=("moved",),
)

ENGINE_QUESTIONS: Final = (OVERRIDE, WALK_WAIVER, ACKNOWLEDGE, CLEAR, REFLECTORS)

"""What moves by hand when F8 is pressed, and whether the arm still stands as it did when that was read."""

from collections.abc import Callable, Sequence
from typing import Final

from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.jog_client import Step
from catseye.app.tui.jog_text import fresh_joints
from catseye.app.tui.motion_text import row, speed_rows, way_rows
from catseye.drivers.roles.pose import SAME_PLACE

CHECKED: Final = "no: limits and bodies are checked before it begins"
"""Motions by hand belong to no plan."""


def jog_begin_lines(engine: EngineState, percent: float) -> list[str]:
    """Return what the beginning of a jog does.

    Args:
        percent: speed override that is asked for.
    """
    kind = "emulators" if engine.bench_simulated else "a REAL ARM, whose cell has to be named on this screen"
    return [
        f"The drives go on; this is {kind}.",
        row("target", "none: nothing moves until you press a key"),
        *speed_rows(engine, percent),
        row("rehearsed", CHECKED),
    ]


def jog_motion_lines(
    engine: EngineState, what: str, target: Sequence[float] | None, now_s: float
) -> list[str]:
    """Return a motion by hand: what, where to, how far, how fast.

    Args:
        what: moves, in words.
        target: one value an axis; None where only the engine knows it.
        now_s: monotonic time, s.
    """
    percent = _percent(engine)
    where = (
        [row("target", "from the present position; the engine calculates how far that is")]
        if target is None
        else way_rows(engine, target, now_s, percent)
    )
    return [what, *where, *speed_rows(engine, percent), row("rehearsed", CHECKED)]


def step_target(engine: EngineState, step: Step, now_s: float) -> tuple[float, ...] | None:
    """Return the joints after a step of one axis alone; None where more moves, or nobody knows where it stands."""
    here, axes = fresh_joints(engine, now_s), () if engine.bench is None else engine.bench.axes
    names = [axis.name.lower() for axis in axes]
    if here is None or step.aim is not None or step.joint not in names or len(names) != len(here):
        return None
    place = names.index(step.joint)
    return (*here[:place], here[place] + step.by, *here[place + 1 :])


def arm_changed(engine: EngineState, now_s: Callable[[], float]) -> Callable[[], str]:
    """Return what says whether the arm does not stand as it does now any more; empty as long as it does.

    Args:
        now_s: monotonic time, s.
    """
    before, percent = fresh_joints(engine, now_s()), _percent(engine)

    def changed() -> str:
        now = fresh_joints(engine, now_s())
        if before is None or now is None:
            return "" if before is now else "the arm's position is not up to date"
        if any(abs(at - was) > SAME_PLACE for was, at in zip(before, now, strict=True)):
            return "the arm has moved meanwhile"
        return "" if _percent(engine) == percent else "the speed override has changed"

    return changed


def _percent(engine: EngineState) -> float | None:
    return None if engine.jog is None else engine.jog.percent

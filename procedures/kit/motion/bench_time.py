"""How far a run is, in expected bench seconds."""

from catseye.procedures.kit.context import Context


class BenchTime:
    """Reports the progress of a plan.

    Steps that were stored before count as done, but the pace counts from the first step that runs now. What a
    recovery takes is done and to do at once, so the end of the run moves by as much and the pace stays honest.

    Args:
        total_s: expected time of the whole plan, s.
    """

    def __init__(self, ctx: Context, total_s: float) -> None:
        self._ctx = ctx
        self._total_s = total_s
        self._done_s = 0.0
        self._extra_s = 0.0
        self._begun = False

    def begin(self) -> None:
        """Take note that a step really runs."""
        if not self._begun:
            self._begun = True
            self._ctx.progress(self._done_s, self._total_s)

    def passed(self, planned_s: float, extra_s: float, text: str) -> None:
        """Take note of a step that is done."""
        self._done_s += planned_s
        self._extra_s += extra_s
        if self._begun:
            self._ctx.progress(self._done_s + self._extra_s, self._total_s + self._extra_s, text)

    def cut_short(self, text: str) -> None:
        """Take note that nothing more is to be done."""
        done_s = self._done_s + self._extra_s
        self._ctx.progress(done_s, done_s, text)

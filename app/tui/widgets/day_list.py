"""The stages of a cell's way: how far each is, what it gave, and Enter for the one under the cursor."""

from collections.abc import Sequence
from typing import Final

from textual.content import Content
from textual.message import Message
from textual.widgets import OptionList
from textual.widgets.option_list import Option

from catseye.app.results.readiness.stages import CellStage

_SIGNS: Final = {"done": "✓", "failed": "✗", "next": "→", "later": "·", "left out": "–"}
_STYLES: Final = {"done": "$success", "failed": "$error", "next": "bold $primary", "left out": "dim"}


class DayList(OptionList):
    """A line for each stage, and below it the figure that it gave."""

    DEFAULT_CSS = """
    DayList { border: none; padding: 0; background: $background; scrollbar-size-vertical: 1; }
    """

    class Chosen(Message):
        """The cursor stands on a stage."""

        def __init__(self, stage: CellStage) -> None:
            super().__init__()
            self.stage = stage

    class Opened(Chosen):
        """A stage is to be done, or shown where it is done."""

    def __init__(self, *, id: str) -> None:
        super().__init__(id=id, compact=True, markup=False)
        self._stages: tuple[CellStage, ...] = ()

    def show_stages(self, stages: Sequence[CellStage]) -> None:
        """Show the stages, the cursor on the next one, or on the last one that is done where none is next.

        It stays where it is while nothing has changed.
        """
        if tuple(stages) == self._stages:
            return
        self._stages = tuple(stages)
        self.clear_options()
        self.add_options(Option(_content(stage), id=f"stage-{n}") for n, stage in enumerate(self._stages))
        if self._stages:
            self.highlighted = _at(self._stages)

    def on_resize(self) -> None:
        """Keep the stage under the cursor in sight."""
        # The list has the height of before until it has been laid out.
        self.call_after_refresh(self.scroll_to_highlight)

    def on_option_list_option_highlighted(self, event: OptionList.OptionHighlighted) -> None:
        """Say on which stage the cursor stands."""
        event.stop()
        self.post_message(self.Chosen(self._stages[event.option_index]))

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Open the stage."""
        event.stop()
        self.post_message(self.Opened(self._stages[event.option_index]))


def _at(stages: Sequence[CellStage]) -> int:
    """Return the place of the next stage; where none is next, of the last one that is over."""
    states = [stage.state for stage in stages]
    if "next" in states:
        return states.index("next")
    return max((n for n, state in enumerate(states) if state in {"done", "failed"}), default=0)


def _content(stage: CellStage) -> Content:
    name = Content.styled(f"{_SIGNS[stage.state]} {stage.name}", _STYLES.get(stage.state, ""))
    if stage.lost:
        return Content.assemble(name, "\n", Content.styled(f"  {stage.lost}", "$warning"))
    if not stage.found:
        return name
    return Content.assemble(name, "\n", Content.styled(f"  {stage.found}", "$text-muted"))

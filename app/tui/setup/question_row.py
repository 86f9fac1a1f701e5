"""One question of the wizard: title, answer, and what is wrong with it."""

from collections.abc import Iterator
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical
from textual.message import Message
from textual.widget import Widget
from textual.widgets import Input, Label, Select

from catseye.app.cell.wizard.question import Question
from catseye.app.tui.widgets.fault import Fault


class Choice(Select[str], inherit_bindings=False):
    """Answers to choose from; up and down go to the questions before and after it, as from every other answer."""

    BINDINGS: ClassVar[list[BindingType]] = [Binding("enter,space", "show_overlay", "Show menu", show=False)]


class Answered(Message):
    """An answer was typed or chosen.

    Attributes:
        question: that was answered.
        text: the answer.
    """

    def __init__(self, question: Question, text: str) -> None:
        super().__init__()
        self.question = question
        self.text = text


class QuestionRow(Vertical):
    """A question.

    Args:
        default: what is taken without one.
    """

    DEFAULT_CSS = """
    QuestionRow { height: auto; }
    QuestionRow Horizontal { height: 1; }
    QuestionRow .title { width: 24; }
    QuestionRow Input { width: 1fr; background: $panel; }
    QuestionRow Input:focus { background: $primary-muted; }
    QuestionRow Select { width: 1fr; }
    """

    def __init__(self, question: Question, text: str, default: str) -> None:
        super().__init__()
        self.question = question
        self._answer = text
        self._default = default

    def compose(self) -> ComposeResult:
        """Title and field, the fault below."""
        with Horizontal():
            yield Label(self.question.title, classes="title", markup=False)
            yield self._select() if self.question.choices else self._input()
        yield Fault()

    @property
    def field(self) -> Widget:
        """Where the answer is typed or chosen."""
        return self.query_one(Select if self.question.choices else Input)

    def show_fault(self, text: str) -> None:
        """Show what is wrong with the answer."""
        self.query_one(Fault).show_fault(text)

    def on_input_changed(self, event: Input.Changed) -> None:
        """Take what is typed."""
        event.stop()
        self._take(event.value)

    def on_select_changed(self, event: Select.Changed) -> None:
        """Take a choice."""
        event.stop()
        self._take("" if event.value is Select.NULL else str(event.value))

    def _take(self, text: str) -> None:
        # Fields report their first value too, which nobody has typed.
        if text != self._answer:
            self._answer = text
            self.post_message(Answered(self.question, text))

    def _input(self) -> Input:
        hint = f"default {self._default}" if self._default else "not answered yet"
        return Input(self._answer, placeholder=hint, compact=True, select_on_focus=False)

    def _select(self) -> Select[str]:
        known = self._answer in {choice.text for choice in self.question.choices}
        prompt = f"default {self._default}" if self._default else "not answered yet"
        return Choice(
            list(self._options()),
            prompt=prompt,
            value=self._answer if known else Select.NULL,
            allow_blank=not known or bool(self._default),
            compact=True,
        )

    def _options(self) -> Iterator[tuple[str, str]]:
        for choice in self.question.choices:
            yield f"{choice.text}  {choice.words}" if choice.words else choice.text, choice.text

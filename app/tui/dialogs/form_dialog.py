"""A few questions at once."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal
from textual.content import Content
from textual.widgets import Input, Label, Select, Static

from catseye.app.tui.dialogs.box_dialog import BoxDialog


@dataclass(frozen=True)
class Field:
    """One question.

    Attributes:
        name: of the answer.
        label: what is asked.
        value: answer to begin with.
        choices: answers to choose from; empty where something is typed.
        hint: stands beside the answer.
        secret: what is typed is not shown, and taken as it is.
    """

    name: str
    label: str
    value: str
    choices: tuple[str, ...] = ()
    hint: str = ""
    secret: bool = False


Answers = dict[str, str]


class FormDialog(BoxDialog[Answers | None]):
    """Asks; Enter in a field answers, None goes back.

    Args:
        fault: returns what is wrong with answers, empty when nothing is.
    """

    DEFAULT_CSS = """
    FormDialog > Vertical { width: 76; max-height: 92%; }
    FormDialog #text { height: auto; max-height: 6; color: $text-muted; }
    FormDialog Horizontal { height: 1; }
    FormDialog .label { width: 16; }
    FormDialog Input { width: 1fr; min-width: 12; background: $boost; }
    FormDialog Input:focus { background: $primary-muted; }
    FormDialog Select { width: 20; }
    FormDialog .hint { width: auto; max-width: 36; margin-left: 1; color: $text-muted; }
    FormDialog #fault { color: $error; height: auto; margin-top: 1; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("ctrl+s", "answer", "go", id="form.go", tooltip="Enter in a field does it too"),
        Binding("escape", "back", "back", id="form.back"),
    ]

    def __init__(
        self,
        title: str,
        fields: Sequence[Field],
        text: str = "",
        fault: Callable[[Answers], str] = lambda _: "",
    ) -> None:
        super().__init__(title, text)
        self._fields = tuple(fields)
        self._fault = fault

    def body(self) -> ComposeResult:
        """A line each, and what is wrong."""
        if self._text:
            yield Static(self._text, id="text", markup=False)
        for field in self._fields:
            with Horizontal():
                yield Label(field.label, classes="label", markup=False)
                if field.choices:
                    options = [(Content(choice), choice) for choice in field.choices]
                    yield Select(options, value=field.value, allow_blank=False, compact=True, id=field.name)
                else:
                    yield Input(
                        field.value, id=field.name, compact=True, select_on_focus=False, password=field.secret
                    )
                yield Label(field.hint, classes="hint", markup=False)
        yield Static("", id="fault", markup=False)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Answer, or go on to a secret that is not typed yet."""
        secrets = (self.query_one(f"#{field.name}", Input) for field in self._fields if field.secret)
        empty = next((one for one in secrets if not one.value and one is not event.input), None)
        if empty is None:
            self.action_answer()
        else:
            empty.focus()

    def action_answer(self) -> None:
        """Take the answers, if nothing is wrong with them."""
        answers = {field.name: self._value(field) for field in self._fields}
        fault = self._fault(answers)
        if fault:
            self.query_one("#fault", Static).update(f"✗ {fault}")
        else:
            self.dismiss(answers)

    def action_back(self) -> None:
        """Go back."""
        self.dismiss(None)

    def _value(self, field: Field) -> str:
        if field.choices:
            return str(self.query_one(f"#{field.name}", Select).value)
        typed = self.query_one(f"#{field.name}", Input).value
        return typed if field.secret else typed.strip()

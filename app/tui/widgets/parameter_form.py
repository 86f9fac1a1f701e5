"""Parameters of a procedure, a line each: label, value, and what it may be or why it cannot be that."""

from typing import TYPE_CHECKING, Any, Final

from textual.app import ComposeResult
from textual.containers import Horizontal, VerticalScroll
from textual.content import Content
from textual.events import DescendantFocus
from textual.message import Message
from textual.widgets import Input, Label, Select
from textual.worker import Worker

from catseye.app.protocol.parameters import (
    default_text,
    param_text,
    parameter_label,
    range_text,
    short_text,
    typed_fault,
)
from catseye.app.tui.widgets.static_text import StaticText

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.results.readiness.survey_document import ProcedureEntry

Facts = dict[str, Any]
"""JSON schema of a parameter, as pydantic writes it."""

Schema = dict[str, Facts]
"""The parameters by their names."""

_AUTOMATIC: Final = "automatic"
"""Stands where the program chooses a value that is left out."""


class ParameterRow(Horizontal):
    """One parameter.

    Args:
        text: what was typed for it before; empty for its default.
    """

    DEFAULT_CSS = """
    ParameterRow { height: 1; }
    ParameterRow .name { width: 23; }
    ParameterRow Input { width: 12; background: $boost; padding: 0; }
    ParameterRow Input:focus { background: $primary-muted; }
    ParameterRow Select { width: 12; }
    ParameterRow .range { width: 1fr; height: 1; margin-left: 1; color: $text-muted; }
    ParameterRow .range { text-wrap: nowrap; text-overflow: ellipsis; }
    ParameterRow .range.bad { color: $error; }
    """

    class Changed(Message):
        """A value was typed or chosen."""

    def __init__(self, name: str, facts: Facts, text: str) -> None:
        super().__init__()
        self.parameter = name
        self.facts = facts
        self.text = text

    def compose(self) -> ComposeResult:
        """Label, value, range."""
        yield Label(self.label, classes="name", markup=False)
        choices = _choices(self.facts)
        if choices:
            value = self.text if self.text in choices else default_text(self.facts)
            options = [(Content(choice), choice) for choice in choices]
            yield Select(
                options,
                value=value if value in choices else Select.NULL,
                allow_blank=value not in choices,
                compact=True,
            )
        else:
            placeholder = default_text(self.facts) or _AUTOMATIC
            yield Input(self.text, placeholder=placeholder, compact=True, select_on_focus=False)
        yield StaticText(classes="range")

    def on_mount(self) -> None:
        """Say what it may be."""
        self._judge()

    @property
    def fault(self) -> str:
        """Why the value cannot be; empty when it can."""
        return typed_fault(self.facts, self.text)

    @property
    def label(self) -> str:
        """What it is called here, with its unit."""
        return parameter_label(self.parameter, self.facts)

    @property
    def description(self) -> str:
        """What the parameter is, with its range, and its key for scripts."""
        return f"{self.facts.get('description', '')}: {range_text(self.facts)}  (key {self.parameter})"

    def on_input_changed(self, event: Input.Changed) -> None:
        """Judge what is typed, as it is typed."""
        event.stop()
        self._take(event.value)

    def on_select_changed(self, event: Select.Changed) -> None:
        """Take a choice."""
        event.stop()
        self._take("" if event.value is Select.NULL else str(event.value))

    def _take(self, text: str) -> None:
        self.text = "" if text == default_text(self.facts) else text
        self._judge()
        self.post_message(self.Changed())

    def _judge(self) -> None:
        shown = self.query_one(StaticText)
        shown.set_class(bool(self.fault), "bad")
        shown.update(("✗ " if self.fault else "") + short_text(self.facts))


class ParameterForm(VerticalScroll):
    """All parameters of one procedure; what stands at its default is left out of a run's words."""

    DEFAULT_CSS = """
    ParameterForm { height: 1fr; scrollbar-size-vertical: 1; }
    """

    can_focus = False

    procedure = ""
    """Whose parameters are shown; empty while others are being put there."""

    class Described(Message):
        """Another field has the focus."""

        def __init__(self, text: str) -> None:
            super().__init__()
            self.text = text

    def __init__(self) -> None:
        super().__init__()
        self._wanted: tuple[str, Schema, dict[str, str]] | None = None
        self._filling: Worker[None] | None = None

    def show_parameters(self, procedure: str, schema: Schema, typed: dict[str, str]) -> None:
        """Show the fields of a procedure soon; of several that are wanted in a row, those of the last one."""
        self.procedure, self._wanted = "", (procedure, schema, typed)
        if not self.is_filling:
            self._filling = self.run_worker(self._fill(), exit_on_error=False)

    @property
    def is_filling(self) -> bool:
        """The fields that were asked for are not there yet."""
        return self._filling is not None and not self._filling.is_finished

    async def filled(self) -> None:
        """Wait until the fields that were asked for are there."""
        if self._filling is not None:
            await self._filling.wait()

    async def _fill(self) -> None:
        # Never given up half-way: a widget that is cancelled while it is mounted takes the program with it.
        while self._wanted is not None:
            (procedure, schema, typed), self._wanted = self._wanted, None
            with self.app.batch_update():
                await self.remove_children()
                await self.mount_all(
                    ParameterRow(name, facts, typed.get(name, "")) for name, facts in schema.items()
                )
            if self._wanted is None:
                self.procedure = procedure

    def fill(self, parameter: str, text: str) -> None:
        """Put a text into a field, as if it were typed."""
        for row in self.rows:
            if row.parameter == parameter:
                row.query_one(Input).value = text

    @property
    def rows(self) -> list[ParameterRow]:
        """The fields."""
        return list(self.query(ParameterRow))

    @property
    def typed(self) -> dict[str, str]:
        """What is not left at its default, as it was typed."""
        return {row.parameter: row.text for row in self.rows if row.text}

    @property
    def faults(self) -> list[str]:
        """What is wrong, with the labels of the fields."""
        return [f"{row.label}: {row.fault}" for row in self.rows if row.fault]

    def shows_faults(self) -> bool:
        """Show what is wrong; return whether anything is."""
        if faults := self.faults:
            self.notify("\n".join(faults), title="not possible", severity="error", markup=False)
        return bool(faults)

    def params(self, names: set[str]) -> list[str]:
        """Return the chosen parameters as `--param` takes them."""
        return [
            param_text(row.facts, row.parameter, row.text)
            for row in self.rows
            if row.text and row.parameter in names
        ]

    def on_descendant_focus(self, event: DescendantFocus) -> None:
        """Say what the field with the focus is."""
        row = next((each for each in event.widget.ancestors if isinstance(each, ParameterRow)), None)
        if row is not None:
            self.post_message(self.Described(row.description))


def with_run_fields(procedure: "ProcedureEntry", speed: float, *, real: bool) -> Schema:
    """Return the parameters of a procedure and what else a start may choose.

    Args:
        speed: bench seconds in one real second, where nothing is typed.
        real: the devices are real: their time runs as it runs.
    """
    fields = dict(procedure.params)
    if procedure.needs_aim:
        fields["search"] = {
            "type": "string",
            "default": "auto",
            "title": "Aim from search",
            "description": "search to take the aim from: auto (newest of this cell), none (cell file), or a run's "
            "name",
        }
    if not real:
        fields["speed"] = {
            "type": "number",
            "default": speed,
            "title": "Bench speed",
            "minimum": 0.001,
            "maximum": 1e6,
            "description": "bench seconds per real second, for emulators",
        }
    return fields


def _choices(facts: Facts) -> list[str]:
    """Return what can be chosen; nothing where something is typed."""
    found = [
        choice
        for one in facts.get("anyOf", [facts])
        for choice in (["true", "false"] if one.get("type") == "boolean" else one.get("enum", []))
    ]
    return [str(choice) for choice in found]

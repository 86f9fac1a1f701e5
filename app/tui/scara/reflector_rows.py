"""The reflectors of the wizard, a line each."""

from typing import Final

from textual.app import ComposeResult
from textual.containers import Horizontal, Vertical
from textual.events import DescendantFocus
from textual.message import Message
from textual.widgets import Input, Label

from catseye.app.tui.widgets.fault import Fault

Reflector = dict[str, str]

COLUMNS: Final = (("name", "name"), ("x_mm", "x, mm"), ("y_mm", "y, mm"), ("facing_deg", "facing, deg"))
HELP: Final = (
    "x points along the arm at J1 = J2 = 0, y to its left. Place reflectors out of the arm's reach, not behind the "
    "column. facing: direction of the axis; empty: towards J1. ctrl+g adds one, ctrl+y removes this one."
)


class ReflectorField(Input):
    """One value of a reflector.

    Args:
        number: of the reflector, from 0.
        hint: what is taken where nothing is typed.
    """

    def __init__(self, number: int, key: str, text: str, hint: str) -> None:
        super().__init__(text, placeholder=hint, compact=True, select_on_focus=False, id=f"r{number}-{key}")
        self.number = number
        self.key = key


class ReflectorRows(Vertical):
    """Name, place and direction of each cat's eye.

    Args:
        reflectors: as they are typed; changed in place.
    """

    DEFAULT_CSS = """
    ReflectorRows { height: auto; }
    ReflectorRows Horizontal { height: 1; }
    ReflectorRows Label { width: 14; color: $text-muted; }
    ReflectorRows Input { width: 13; margin-right: 1; background: $panel; }
    ReflectorRows Input:focus { background: $primary-muted; }
    """

    class Changed(Message):
        """Something was typed."""

    def __init__(self, reflectors: list[Reflector]) -> None:
        super().__init__()
        self._reflectors = reflectors
        self._current = 0

    def compose(self) -> ComposeResult:
        """A line of titles, a line for each reflector."""
        with Horizontal():
            for _, title in COLUMNS:
                yield Label(title)
        for number, reflector in enumerate(self._reflectors):
            with Horizontal():
                for key, _ in COLUMNS:
                    hint = "to J1" if key == "facing_deg" else ""
                    yield ReflectorField(number, key, reflector.get(key, ""), hint)
            yield Fault(id=f"fault{number}")

    async def add(self) -> None:
        """Add an empty line."""
        taken = {one.get("name") for one in self._reflectors}
        name = next(f"P{n}" for n in range(1, len(taken) + 2) if f"P{n}" not in taken)
        self._reflectors.append({"name": name, "x_mm": "", "y_mm": "", "facing_deg": ""})
        await self._again(len(self._reflectors) - 1)

    async def take_away(self) -> None:
        """Take the line with the focus away."""
        if self._reflectors:
            del self._reflectors[min(self._current, len(self._reflectors) - 1)]
            await self._again(max(self._current - 1, 0))

    def show_faults(self, faults: dict[str, str]) -> None:
        """Show what is wrong.

        Args:
            faults: by key, `reflector.0.x_mm`.
        """
        for number in range(len(self._reflectors)):
            mine = [text for key, text in faults.items() if key.startswith(f"reflector.{number}.")]
            self.query_one(f"#fault{number}", Fault).show_fault("; ".join(mine))

    def on_descendant_focus(self, event: DescendantFocus) -> None:
        """Note which reflector is meant."""
        if isinstance(event.widget, ReflectorField):
            self._current = event.widget.number

    def on_input_changed(self, event: Input.Changed) -> None:
        """Take what is typed."""
        event.stop()
        field = event.input
        if (
            isinstance(field, ReflectorField)
            and self._reflectors[field.number].get(field.key, "") != event.value
        ):
            self._reflectors[field.number][field.key] = event.value.strip()
            self.post_message(self.Changed())

    async def _again(self, number: int) -> None:
        self._current = number
        await self.recompose()
        for field in self.query(f"#r{number}-x_mm").results(Input):
            field.focus()
        self.post_message(self.Changed())

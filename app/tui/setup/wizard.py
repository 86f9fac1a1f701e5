"""The questions, a page for each topic; what is wrong stands beside the answer."""

import asyncio
import copy
from pathlib import Path
from typing import ClassVar, Final

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Container, Horizontal, Vertical
from textual.content import Content
from textual.events import DescendantFocus
from textual.timer import Timer

from catseye.app.cell.wizard.draft import Draft, default_text
from catseye.app.cell.wizard.pages import Page
from catseye.app.engine.instruments import require_drivers
from catseye.app.tui.scara.reflector_rows import HELP, ReflectorRows
from catseye.app.tui.setup.question_row import Answered, QuestionRow
from catseye.app.tui.widgets.fault import Fault
from catseye.app.tui.widgets.static_text import StaticText, lines
from catseye.drivers.roles.registry import broken_drivers

_PAUSE_S: Final = 0.15
"""After the last key, before the answers are judged."""

FILE: Final = "file"


class Wizard(Horizontal):
    """Asks for a cell file.

    Attributes:
        draft: answers so far.
        faults: what is wrong by key, when it was judged last.
        page: that is shown.
    """

    DEFAULT_CSS = """
    Wizard { height: 1fr; }
    Wizard #pages { width: 19; padding: 0 1; background: $surface; }
    Wizard #asked { width: 1fr; height: 1fr; padding: 0 1; }
    Wizard #intro { text-style: bold; height: 1; }
    Wizard #form { height: 1fr; overflow-y: auto; scrollbar-size-vertical: 1; }
    Wizard #rows { height: auto; }
    Wizard #help { height: 3; color: $text-muted; }
    Wizard #summary { height: auto; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("down", "down", "next field", show=False, id="setup.down", tooltip="on the summary: scroll"),
        Binding("up", "up", "field before", show=False, id="setup.up", tooltip="on the summary: scroll"),
    ]

    def __init__(self, draft: Draft) -> None:
        super().__init__()
        self.draft = draft
        self.faults: dict[str, str] = {}
        self.page: Page = draft.pages[0]
        self._judging: Timer | None = None

    def compose(self) -> ComposeResult:
        """Pages to the left, questions to the right, help below."""
        yield StaticText(id="pages")
        with Vertical(id="asked"):
            yield StaticText(id="intro")
            # Not a scrollable widget of its own: page up and page down turn the pages.
            with Container(id="form"):
                yield Vertical(id="rows")
                yield Fault(id="page-fault")
            yield StaticText(id="help")

    async def on_mount(self) -> None:
        """Show the first page."""
        await self.show_page(self.page)
        self._judge_soon()
        for text in broken_drivers().values():
            self.notify(text, title="left out", severity="warning", timeout=20.0, markup=False)

    @property
    def path(self) -> Path:
        """Where the file is written."""
        return Path(self.draft.answer(FILE)).expanduser()

    def action_down(self) -> None:
        """Go to the next field, or scroll where there is none."""
        if self.page.name == "summary":
            self.query_one("#form", Container).scroll_down(animate=False)
        else:
            self.screen.focus_next()

    def action_up(self) -> None:
        """Go to the field before, or scroll where there is none."""
        if self.page.name == "summary":
            self.query_one("#form", Container).scroll_up(animate=False)
        else:
            self.screen.focus_previous()

    async def turn(self, by: int) -> None:
        """Show the next page or the one before."""
        pages = self.draft.pages
        await self.show_page(pages[min(max(pages.index(self.page) + by, 0), len(pages) - 1)])

    async def show_page(self, page: Page) -> None:
        """Show a page."""
        await self._fill(page, "")

    async def _fill(self, page: Page, key: str) -> None:
        """Show a page with the focus on a question; empty for the first."""
        self.page = page
        rows = self.query_one("#rows", Vertical)
        with self.app.batch_update():
            await rows.remove_children()
            if page.name == "summary":
                await rows.mount(StaticText(id="summary"))
            elif page.name == "reflector":
                await rows.mount(ReflectorRows(self.draft.reflectors))
            else:
                await rows.mount_all(
                    QuestionRow(
                        question,
                        self.draft.answer(question.key),
                        question.default or default_text(question.key),
                    )
                    for question in self.draft.questions(page)
                )
        self.query_one("#intro", StaticText).set_text(Content(page.intro))
        self.query_one("#help", StaticText).set_text(Content(HELP if page.name == "reflector" else ""))
        self._show_faults()
        self._focus(key)

    async def add_reflector(self) -> None:
        """Add a line for a reflector."""
        for rows in self.query(ReflectorRows):
            await rows.add()

    async def remove_reflector(self) -> None:
        """Take the line of a reflector away."""
        for rows in self.query(ReflectorRows):
            await rows.take_away()

    async def judge(self) -> None:
        """Have the model judge all answers, beside the screen."""
        draft = copy.deepcopy(self.draft)
        self.faults = await asyncio.to_thread(draft.faults, require_drivers)
        if self.is_attached:
            self._show_faults()

    async def on_answered(self, event: Answered) -> None:
        """Take an answer; other questions may follow from a choice."""
        event.stop()
        key = event.question.key
        self.draft.give(key, event.text)
        if event.question.kind == "choice":
            await self._fill(self.page, key)
        self._judge_soon()

    def on_reflector_rows_changed(self) -> None:
        """Judge the reflectors anew."""
        self._judge_soon()

    def on_descendant_focus(self, event: DescendantFocus) -> None:
        """Say what is asked where the focus is."""
        row = next((one for one in event.widget.ancestors if isinstance(one, QuestionRow)), None)
        if row is None:
            return
        question = row.question
        shown = [Content(question.help)]
        if question.find_out and not self.draft.answer(question.key):
            shown.append(Content.assemble(("to find out: ", "$warning"), question.find_out))
        self.query_one("#help", StaticText).set_text(lines(*shown))

    def _focus(self, key: str) -> None:
        for row in self.query(QuestionRow):
            if not key or row.question.key == key:
                row.field.focus()
                return
        if self.query(ReflectorRows):
            self.query("ReflectorRows Input").first().focus()
        elif self.page.name == "summary":
            self.can_focus = True
            self.focus()

    def _judge_soon(self) -> None:
        if self._judging is not None:
            self._judging.stop()
        self._judging = self.set_timer(_PAUSE_S, self._judge_now)

    def _judge_now(self) -> None:
        self.run_worker(self.judge(), group="judge", exclusive=True, exit_on_error=False)

    def _show_faults(self) -> None:
        mine = self.draft.page_faults(self.page, self.faults)
        for row in self.query(QuestionRow):
            row.show_fault(mine.get(row.question.key, ""))
        for rows in self.query(ReflectorRows):
            rows.show_faults(mine)
        self.query_one("#page-fault", Fault).show_fault(mine.get(self.page.name, ""))
        self.query_one("#pages", StaticText).set_text(
            lines(*(self._page_line(page) for page in self.draft.pages))
        )
        for summary in self.query("#summary").results(StaticText):
            summary.set_text(self._summary())

    def _page_line(self, page: Page) -> Content:
        wrong = self.draft.page_faults(page, self.faults)
        sign, style = ("✗", "$error") if wrong else ("✓", "$success")
        shown = page is self.page
        return Content.assemble(
            (f"{sign} ", style), "▸" if shown else " ", (page.title, "bold" if shown else "")
        )

    def _summary(self) -> Content:
        shown: list[Content] = [Content.assemble("file  ", (str(self.path), "bold"))]
        for page in self.draft.pages:
            for key, text in self.draft.page_faults(page, self.faults).items():
                shown.append(Content.assemble(("✗ ", "$error"), f"{page.title}: {key}: {text}"))
        if not self.faults:
            shown.append(Content.assemble(("✓ ", "$success"), "all checks passed: ctrl+s writes the file"))
        for text in self.draft.to_find_out():
            shown.append(Content.assemble(("? ", "$warning"), text))
        for text in self.draft.left_open():
            shown.append(Content.assemble(("! ", "$warning"), text))
        return lines(*shown)

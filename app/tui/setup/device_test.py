"""Looks at one device of a cell file in the making: who answers, what is wrong, what to do."""

import asyncio
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.content import Content

from catseye.app.results.model import Sign, Statement
from catseye.app.results.numbers import duration_text
from catseye.app.service.command_process import Work
from catseye.app.tui.dialogs.box_dialog import BoxDialog
from catseye.app.tui.widgets.report_content import section_content, statement_content
from catseye.app.tui.widgets.static_text import StaticText, lines

_NOT_USABLE = 3


class DeviceTest(BoxDialog[None]):
    """Runs `catseye doctor` on one device. Esc cancels, and closes.

    Args:
        work: runs commands.
        now_s: monotonic time, s.
    """

    DEFAULT_CSS = """
    DeviceTest > Vertical { width: 76; max-height: 92%; }
    DeviceTest VerticalScroll { height: auto; max-height: 16; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape,enter", "close", "cancel, close", id="test.close"),
        Binding("ctrl+t", "again", "once more", id="test.again"),
        Binding("c", "copy", "copy", id="test.copy"),
    ]

    def __init__(self, device: str, cell_text: str, work: Work, now_s: Callable[[], float]) -> None:
        super().__init__(f"Connection test: {device}")
        self._device = device
        self._cell_text = cell_text
        self._work = work
        self._now_s = now_s
        self._begun_s = 0.0
        self._looking = False

    def body(self) -> ComposeResult:
        """The findings."""
        with VerticalScroll():
            yield StaticText(id="found")

    def on_mount(self) -> None:
        """Begin at once."""
        self.set_interval(0.5, self._show_time)
        self.action_again()

    def action_again(self) -> None:
        """Look once more."""
        self._begun_s, self._looking = self._now_s(), True
        self._show_time()
        self.run_worker(self._look(), group="look", exclusive=True, exit_on_error=False)

    def action_close(self) -> None:
        """End the test and close."""
        self.workers.cancel_group(self, "look")
        self.dismiss()

    def action_copy(self) -> None:
        """Put the findings on the clipboard."""
        self.app.copy_to_clipboard(self.query_one("#found", StaticText).text.plain)
        self.notify("copied")

    def _show_time(self) -> None:
        if self._looking:
            gone = duration_text(self._now_s() - self._begun_s)
            self.query_one("#found", StaticText).set_text(Content(f"connecting … {gone}   Esc cancels"))

    async def _look(self) -> None:
        try:
            shown = await self._findings()
        finally:
            self._looking = False
        self.query_one("#found", StaticText).set_text(shown)

    async def _findings(self) -> Content:
        # The first screen is painted before this is imported.
        from catseye.app.protocol.examination import CellExamination
        from catseye.app.results.examination import examination_report

        with tempfile.TemporaryDirectory(prefix="catseye-test-") as folder:
            path = Path(folder) / "cell.toml"
            await asyncio.to_thread(path.write_text, self._cell_text, encoding="utf-8")
            done = await self._work.do("doctor", path, "--device", self._device, "--json")
        if done.code not in {0, _NOT_USABLE} or "devices" not in done.data():
            return statement_content(Statement(Sign.BAD, done.fault or "the test ended without a finding"))
        examination = CellExamination.model_validate_json(done.out)
        return lines(
            *(
                Content(section.title) + "\n" + section_content(section)
                for section in examination_report(examination).sections
            )
        )

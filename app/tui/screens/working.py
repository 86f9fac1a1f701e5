"""A screen that lets commands of catseye work, one at a time with progress, and shows the pages that they write."""

import asyncio
import os
import shutil
import sys
from collections.abc import Callable, Coroutine
from functools import partial
from itertools import chain, count
from pathlib import Path
from typing import Any, ClassVar, TypeVar

from textual.worker import Worker

from catseye.app.service.command_process import Done
from catseye.app.tui.screens.base import MainScreen
from catseye.app.tui.session import Session
from catseye.app.tui.widgets.task_line import TaskLine

_INTERRUPTED = frozenset({130, 143})

_OPENERS = ("xdg-open", "open")


def typed_path(text: str) -> Path:
    """Return a path that was typed; ~ is a home folder, and stays what it is where there is none."""
    # The method of Path raises where there is none.
    return Path(os.path.expanduser(text))


def why_not_written(text: str) -> str:
    """Return why a file that was typed cannot be written, empty when it can be."""
    if not text:
        return "a file is needed"
    file = typed_path(text)
    try:
        if file.exists():
            return f"{file.name} is there already: give another name"
    except OSError as error:
        return f"{error.strerror}: give another name"
    if not file.parent.is_dir():
        return f"there is no folder {file.parent}: make it first"
    if not os.access(file.parent, os.W_OK | os.X_OK):
        return f"nothing can be written into {file.parent}: give another folder"
    return ""


def free_name(path: Path) -> Path:
    """Return a path, with a number where its name is taken."""
    names = (path.with_stem(f"{path.stem}-{number}") for number in count(2))
    return next((name for name in chain([path], names) if not name.exists()), path)


Returned = TypeVar("Returned")


class PageScreen(MainScreen):
    """A main screen that shows pages in the system's browser."""

    def spawn(
        self, work: Callable[[], Coroutine[Any, Any, Returned]], group: str, *, exclusive: bool = False
    ) -> Worker[Returned]:
        """Have something done beside the screen, as long as the screen lives.

        Args:
            exclusive: what is under way of its kind is given up.
        """
        worker: Worker[Returned] = self.run_worker(
            work, group=group, exclusive=exclusive, exit_on_error=False
        )
        return worker

    def show_page(self, page: Path) -> None:
        """Show a page; where there is no display, say where it is."""
        if can_open():
            self.spawn(partial(self._open, page.absolute().as_uri()), "open")
        else:
            self.notify(f"there is no display here; the page is {page}", markup=False, timeout=12.0)

    async def _open(self, uri: str) -> None:
        if fault := await open_page(uri):
            self.catseye.show_error("The page is not shown", f"{uri}: {fault}")


class WorkScreen(PageScreen):
    """A main screen whose body holds a `TaskLine`.

    Attributes:
        opens: how a page that was written is shown in the browser.
    """

    opens: ClassVar[str] = "o opens it in the browser"

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._page: Path | None = None
        self._work: Worker[None] | None = None

    @property
    def working(self) -> bool:
        """A command is under way."""
        return self._work is not None and not self._work.is_finished

    def let_work(
        self,
        title: str,
        failure: str,
        *arguments: str | Path,
        done: Callable[[Done], None],
    ) -> None:
        """Have a command do something; an error is shown with its remedy. Returns at once.

        Args:
            failure: title of the error when it fails.
            arguments: of the command.
            done: is given how it ended, when it ended well.
        """
        if self.working:
            self.notify("one thing at a time: Esc cancels what is under way", severity="warning")
            return
        work = partial(self._let_work, title, failure, arguments, done)
        self._work = self.spawn(work, "work")

    def cancel_work(self) -> bool:
        """End the command under way; return whether there was one."""
        if self._work is None or self._work.is_finished:
            return False
        self.query_one(TaskLine).ending()
        self._work.cancel()
        return True

    def show_written(self, path: Path, text: str = "") -> None:
        """Say which file was written; a page can be opened with `action_open_page`."""
        page = path.suffix == ".html"
        if page:
            self._page = path
        how = f"\n{self.opens}" if page and can_open() else ""
        self.notify(f"{path}{how}", title=text or "written", timeout=12.0, markup=False)

    def action_open_page(self) -> None:
        """Show the last report in the system's browser."""
        if self._page is None:
            self.notify("no report was written yet: p writes one", severity="warning")
        else:
            self.show_page(self._page)

    async def _let_work(
        self,
        title: str,
        failure: str,
        words: tuple[str | Path, ...],
        done: Callable[[Done], None],
    ) -> None:
        line = self.query_one(TaskLine)
        line.begin(title)
        try:
            with self.session.at_work(title):
                ended = await self.session.work.do(*words, heard=line.hear)
        except asyncio.CancelledError:
            if self.is_attached:
                self.notify(f"{title}: cancelled", markup=False)
            raise
        except OSError as error:
            self.catseye.show_error(failure, f"catseye could not be started: {error}")
            return
        finally:
            line.end()
        if ended.code == 0:
            done(ended)
        elif ended.code in _INTERRUPTED:
            self.notify(f"{title}: interrupted from outside", markup=False)
        else:
            self.catseye.show_error(failure, ended.fault)


def can_open() -> bool:
    """Return whether there is a display, and a program that shows pages on it."""
    display = sys.platform == "darwin" or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    return display and _opener() is not None


async def open_page(uri: str) -> str:
    """Show a page; return why it is not shown, empty when it is."""
    opener = _opener()
    if opener is None:
        return "neither xdg-open nor open is installed"
    # A browser in the terminal would draw over the screen: it is given none.
    process = await asyncio.create_subprocess_exec(
        opener,
        uri,
        stdin=asyncio.subprocess.DEVNULL,
        stdout=asyncio.subprocess.DEVNULL,
        stderr=asyncio.subprocess.DEVNULL,
        start_new_session=True,
    )
    code = await process.wait()
    return f"{opener} ended with code {code}" if code else ""


def _opener() -> str | None:
    return next((found for name in _OPENERS if (found := shutil.which(name)) is not None), None)

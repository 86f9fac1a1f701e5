"""What a run that has ended came to: its findings, and the files that were written of it."""

import asyncio
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from catseye.app.results.readiness.after_run import result_to_validate, validation
from catseye.app.results.readiness.run_files import NO_FILES, files_of_run
from catseye.app.service.command_process import Work

if TYPE_CHECKING:
    # The first screen is painted before these are imported.
    from catseye.app.results.said import Said
    from catseye.app.service.command_process import Done


class RunFindings:
    """Looks after the end of a run: commands in processes of their own evaluate, and files are read in threads.

    Attributes:
        run: its name.
        looking: what is evaluated now; empty when all is known.
        result: that the run shows the worth of; None without one.
        written: files of the run, by what wrote them.
        files: what was made of the run before, whoever made it.
    """

    def __init__(self, run: str, procedure: str, root: Path) -> None:
        self.run = run
        self.looking = ""
        self.result: Path | None = None
        self.written: dict[str, Path] = {}
        self.files = NO_FILES
        self._procedure = procedure
        self._root = root
        self._own: tuple[Said, ...] = ()
        self._of_result: tuple[Said, ...] = ()

    @property
    def said(self) -> "tuple[Said, ...]":
        """What was found, in order; of a result what stands for it comes first."""
        return (*self._of_result, *self._own)

    @property
    def page(self) -> Path | None:
        """The page that was written last."""
        return next((file for file in reversed(self.written.values()) if file.suffix == ".html"), None)

    async def look(self, work: Work, *, complete: bool, changed: Callable[[], None]) -> None:
        """Find out what the run came to.

        Args:
            complete: it did all that it was to do, so a result can be held against it.
            changed: called when more is known.
        """
        self.looking = "evaluating the run …"
        changed()
        try:
            self._own = _verdicts(await work.do("show", self.run, "--runs", self._root, "--json"))
            if complete:
                self.result = await asyncio.to_thread(
                    result_to_validate, self.run, self._procedure, self._root
                )
            await self._look_for_files()
            changed()
            if self.result is not None:
                self.looking = f"comparing it with {self.result.name} …"
                changed()
                words = validation(self.result, self.run, self._root)
                self._of_result = _verdicts(await work.do(*words, "--json"))
        finally:
            self.looking = ""
            changed()

    async def note_written(self, name: str, file: Path) -> None:
        """Take note of a file of the run, and of what a result is worth.

        Args:
            name: of what wrote it.
        """
        self.written.pop(name, None)
        self.written[name] = file
        await self._look_for_files()
        if file.suffix == ".json":
            self._of_result = await asyncio.to_thread(_worth, name, file)

    async def _look_for_files(self) -> None:
        """Find what lies beside the runs; what was written here just now stays the newest."""
        self.files = await asyncio.to_thread(files_of_run, self.run, self._root, self.result)
        known = set(self.written.values())
        earlier = {name: file for name, file in self.files.written().items() if file not in known}
        self.written = earlier | self.written


def _verdicts(done: "Done") -> "tuple[Said, ...]":
    """Return what a command says in sentences; nothing of one that failed: the record is there all the same."""
    from catseye.app.results.said import Verdicts

    try:
        return () if done.code else done.document(Verdicts).said
    except ValueError:
        return ()


def _worth(name: str, file: Path) -> "tuple[Said, ...]":
    """Return what stands for a result."""
    from catseye.app.results.headlines import headline_of_result
    from catseye.app.results.model import Sign
    from catseye.app.results.said import Said

    found = headline_of_result(file)
    if found is None:
        return ()
    sign = Sign.GOOD if found.holds else Sign.BAD
    return (Said(sign=sign, text=f"{name}: {found.text}", short=f"{name}: {found.text}"),)

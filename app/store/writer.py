"""The one connection that writes, in the one thread that owns it."""

import asyncio
import os
import sqlite3
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any, TypeVar

from catseye.app.errors import StorageError
from catseye.app.store.schema import open_writer

T = TypeVar("T")
Job = Callable[[sqlite3.Connection], T]


class Writer:
    """Runs jobs in transactions, in order; after one failure it refuses every further one.

    A failed fsync may have dropped the data it was asked to keep, so nothing after it can be trusted.

    Args:
        on_failure: called once, in the writer's thread, when storage fails.
    """

    def __init__(self, path: Path, on_failure: Callable[[StorageError], None]) -> None:
        self._path = path
        self._on_failure = on_failure
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="run-store")
        self._connection: sqlite3.Connection | None = None
        self._files: dict[Path, tuple[int, int]] = {}
        self._closed = False
        self.failure: StorageError | None = None

    async def open(self) -> None:
        """Open the file.

        Raises:
            StorageError: it cannot be opened; the thread has ended.
        """
        try:
            await asyncio.wrap_future(self._thread.submit(self._open))
        except BaseException:
            await self.close()
            raise

    def submit(self, job: Job[T]) -> "Future[T]":
        """Queue a job; the future's result stands for a finished COMMIT.

        Raises:
            StorageError: storage has failed before.
        """
        if self.failure is not None:
            raise self.failure
        if self._closed:
            raise StorageError(f"{self._path} is closed; open the run again")
        return self._thread.submit(self._run, job)

    async def transact(self, job: Job[T]) -> T:
        """Run a job and return when it is committed.

        Raises:
            StorageError: storage fails now or has failed before.
        """
        return await asyncio.wrap_future(self.submit(job))

    def fail(self, text: str, cause: BaseException) -> StorageError:
        """Remember the first failure and return the error that stands for it."""
        if self.failure is None:
            self.failure = StorageError(text)
            self.failure.__cause__ = cause
            self._on_failure(self.failure)
        return self.failure

    async def close(self, last: Job[Any] | None = None) -> None:
        """Run a last job outside a transaction, close the connection and end the thread.

        May be called any number of times; only the first one counts.

        Raises:
            StorageError: the last job failed.
        """
        if self._closed:
            return
        self._closed = True
        try:
            await asyncio.wrap_future(self._thread.submit(self._close, last))
        finally:
            self._thread.shutdown(wait=True)

    def _open(self) -> None:
        self._connection = open_writer(self._path)
        self._files = {path: _identity(path) for path in (self._path, Path(f"{self._path}-wal"))}

    def _require_same_files(self) -> None:
        """Check that what was written is what others find below these names.

        A file that was removed or replaced takes everything that is written into it along, without any error.

        Raises:
            OSError: it is another one, or gone.
        """
        for path, identity in self._files.items():
            if _identity(path) != identity:
                raise OSError(f"{path.name} was replaced by another file while the run was going on")

    def _opened(self) -> sqlite3.Connection:
        if self._connection is None:
            raise StorageError(f"{self._path} is not open; await open() first")
        return self._connection

    def _run(self, job: Job[T]) -> T:
        if self.failure is not None:
            raise self.failure
        connection = self._opened()
        try:
            # The context manager commits; it rolls back when the job or the commit raises.
            with connection:
                connection.execute("BEGIN IMMEDIATE")
                result = job(connection)
            self._require_same_files()
            return result
        except (sqlite3.Error, OSError) as error:
            raise self.fail(f"cannot write {self._path}: {error}; nothing more is stored", error) from error

    def _close(self, last: Job[Any] | None) -> None:
        if self._connection is None:
            return
        try:
            if last is not None:
                last(self._connection)
        except (sqlite3.Error, OSError) as error:
            raise self.fail(f"cannot close {self._path}: {error}", error) from error
        finally:
            self._connection.close()
            self._connection = None


def _identity(path: Path) -> tuple[int, int]:
    found = os.lstat(path)
    return found.st_dev, found.st_ino

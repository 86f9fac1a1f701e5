"""Writing one run: what has been acknowledged survives the death of the process.

Promise:
1. A call that returned is durable: it resolves after COMMIT with synchronous=FULL.
2. A step is done only in the same transaction as its rows.
3. Nothing is dropped silently: lines cut from a bounded log are counted in the closing record.
4. A recording's readings are kept chunk by chunk; they count when the step that names the recording is done.
5. After one failure the store refuses everything more and says so to `on_failure`.
"""

import asyncio
import sqlite3
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping
from concurrent.futures import Future
from pathlib import Path

from catseye.app.errors import StorageError, UsageError
from catseye.app.files.crash_points import crash_point
from catseye.app.store import seal
from catseye.app.store.chunks import Chunk, Key, begun_attempts, pack
from catseye.app.store.lines import DEFAULT_MAX_BYTES, HEALS, JsonLines, WireLog
from catseye.app.store.lock import RunLock
from catseye.app.store.new_run import clock_anchor, make_directory, require_space, software
from catseye.app.store.reader import Accept, RunReader
from catseye.app.store.resumable import REJECTED
from catseye.app.store.rows import Value, encode, insert, insert_data, to_json
from catseye.app.store.schema import CHUNKS, settle
from catseye.app.store.tables import declare, require_fitting
from catseye.app.store.writer import Writer
from catseye.drivers.roles.clock import Clock
from catseye.procedures.kit.records import Json, Record, Row, Table, tables_of

DEFAULT_RESERVE_BYTES = 200 * 1024 * 1024

# A running experiment may use most of what was free at its start before it has to give up.
_RUNNING_SHARE = 0.1


class RunStore:
    """The store of one run; made by `create` or `reopen`, ended by `finish` or `abandon`.

    Attributes:
        path: the run's directory.
        wire: transcript of the links; give `wire.record` to recording transports.
        log: the application's log.
        on_failure: called in the event loop when storage has failed outside of an awaited call.
        resumed: the run was begun by another process, or ended before, and goes on.
    """

    def __init__(self, path: Path, clock: Clock, reserve_bytes: int, max_log_bytes: int) -> None:
        self.path = path
        self.resumed = False
        self.on_failure: Callable[[StorageError], None] = lambda _error: None
        self._loop = asyncio.get_running_loop()
        self._clock = clock
        self._reserve_bytes = reserve_bytes
        self._lock = RunLock(path)
        try:
            self.wire = WireLog(path / seal.WIRE_LOG, clock, self._log_failed, max_log_bytes)
            self.log = JsonLines(path / seal.APP_LOG, clock, self._log_failed, max_log_bytes)
        except OSError as error:
            self._lock.release()
            raise StorageError(f"cannot write into {path}: {error}") from error
        self._writer = Writer(path / seal.DATABASE, self._storage_failed)
        self._results: dict[str, Row] = {}
        self._attempts: dict[str, int] = {}
        self._tables: dict[str, Table] = {}

    @classmethod
    async def create(
        cls,
        root: Path,
        procedure: str,
        meta: Mapping[str, Json],
        clock: Clock,
        *,
        records: Collection[type[Record]] = (),
        reserve_bytes: int = DEFAULT_RESERVE_BYTES,
        max_log_bytes: int = DEFAULT_MAX_BYTES,
    ) -> "RunStore":
        """Create a run's directory and open it.

        Args:
            root: directory of all runs; created when missing.
            procedure: name of the procedure, part of the run's name.
            meta: what the run says about itself, beside versions and clock anchor.
            clock: stamps every record.
            reserve_bytes: free space that must be there.
            max_log_bytes: where each log file is cut.

        Raises:
            StorageError: no space, no permission, or the file system does not take the durable settings.
        """
        path = make_directory(root, procedure, clock, reserve_bytes)
        crash_point("directory-made")
        store = await cls._open(path, clock, records, reserve_bytes, max_log_bytes)
        about: dict[str, Json] = {"run": path.name, "procedure": procedure, "software": software()}
        try:
            await store.append_meta({**about, "clock_anchor": clock_anchor(clock), **meta})
            await store.event("run-opened")
            crash_point("run-opened")
        except BaseException:
            await store.abandon()
            raise
        return store

    @classmethod
    async def reopen(
        cls,
        path: Path,
        clock: Clock,
        about: Mapping[str, Json] | None = None,
        *,
        records: Collection[type[Record]] = (),
        reserve_bytes: int = DEFAULT_RESERVE_BYTES,
    ) -> "RunStore":
        """Go on with a run that died or ended early; its done steps keep their results.

        Args:
            path: the run's directory.
            clock: stamps every record.
            about: what is to be stored with the reopening, beside versions and clock anchor.
            reserve_bytes: free space that must be there.

        Raises:
            UsageError: the run is complete.
            StorageError: another process writes it, its tables are other ones, or it cannot be opened.
        """
        # Whoever planned how it goes on has compared it with its manifest, off the event loop.
        reader = RunReader(path, Accept.UNCHECKED)
        before = reader.status
        if before == "complete":
            raise UsageError(f"{path.name} is complete; start a new run")
        if before == "running":
            raise StorageError(f"{path} is being written by a running catseye; stop that first")
        # While the run is still sealed: what is refused stays as it was.
        seal.require_own_files(path)
        require_fitting(reader.tables(), tables_of(records))
        require_space(path, reserve_bytes)
        # A process that is just sealing the run has stored its closing record and still holds the lock.
        lock = RunLock(path)
        try:
            seal.unseal(path)
            settle(path / seal.DATABASE)
        finally:
            lock.release()
        crash_point("unsealed")
        store = await cls._open(path, clock, records, reserve_bytes, DEFAULT_MAX_BYTES, reader)
        facts: dict[str, Json] = {
            "before": before,
            "software": software(),
            "clock_anchor": clock_anchor(clock),
        }
        await store.event("run-reopened", {**facts, **(about or {})})
        crash_point("reopened")
        return store

    @classmethod
    async def _open(
        cls,
        path: Path,
        clock: Clock,
        records: Collection[type[Record]],
        reserve_bytes: int,
        max_log_bytes: int,
        before: RunReader | None = None,
    ) -> "RunStore":
        store = cls(path, clock, reserve_bytes, max_log_bytes)
        if before is not None:
            store.resumed = True
            store._restore(before)
        try:
            await store._writer.open()
            store._tables = await store._writer.transact(lambda db: declare(db, tables_of(records)))
        except BaseException:
            await store.abandon()
            raise
        return store

    def _restore(self, reader: RunReader) -> None:
        self._results = {step.step_id: step.result for step in reader.steps()}
        for event in reader.events():
            if event.kind == "step-dropped":
                step_id = str(event.data["step_id"])
                self._attempts[step_id] = self._attempts.get(step_id, 0) + 1
        for step_id, attempt in begun_attempts(reader.path).items():
            # Numbers of an attempt are taken by its chunks, though the process died before it could say more.
            self._attempts[step_id] = max(self._attempts.get(step_id, 0), attempt)

    @property
    def failure(self) -> StorageError | None:
        """The first failure; the store refuses everything after it."""
        return self._writer.failure

    async def append_meta(self, values: Mapping[str, Json]) -> None:
        """Add what the run says about itself; a key is written once."""
        pairs = [(key, to_json(value)) for key, value in values.items()]

        def job(db: sqlite3.Connection) -> None:
            for pair in pairs:
                insert(db, "meta", pair)

        await self._writer.transact(job)

    def stored_result(self, step_id: str) -> Row | None:
        """Return the result of a step that is done, None when it is not."""
        return self._results.get(step_id)

    def next_attempt(self, step_id: str) -> int:
        """Return the number of the coming attempt at a step, from 1."""
        return self._attempts.get(step_id, 0) + 1

    async def append_step(
        self,
        step_id: str,
        attempt: int,
        title: str,
        result: Row,
        rows: Iterable[tuple[str, Row]],
        *,
        started_utc: str | None = None,
    ) -> None:
        """Store a step's completion and its rows in one transaction.

        Args:
            step_id: stable name within the run.
            attempt: which one this was, from 1.
            started_utc: ISO 8601 UTC time; now when it is None.

        Raises:
            KeyError: no type of records declares the table of a row; nothing is stored.
            ValueError: a row does not fit its table; nothing is stored.
            StorageError: storage failed.
        """
        counts: Counter[str] = Counter()
        encoded: list[tuple[Table, tuple[Value, ...], tuple[Value, ...]]] = []
        for name, row in rows:
            table = self._tables[name]
            counts[name] += 1
            encoded.append((table, (step_id, attempt, counts[name]), encode(table, row)))
        done_utc = self._now()
        step = (step_id, attempt, title, started_utc or done_utc, done_utc, len(encoded), to_json(result))
        self._require_running_space()

        def job(db: sqlite3.Connection) -> None:
            insert(db, "steps", step)
            for table, key, values in encoded:
                insert_data(db, table, key, values)

        await self._writer.transact(job)
        self._results[step_id] = dict(result)

    async def append_chunk(self, recording: Key, seq: int, chunk: Chunk) -> bytes:
        """Store readings of a recording, whether or not its step will come to its end; return their bytes.

        Args:
            recording: step, attempt at it and name.
            seq: number of the chunk in the recording, from 1.

        Raises:
            StorageError: storage failed.
        """
        data = pack(chunk)
        self._require_running_space()
        row = (*recording, seq, len(chunk), data)
        await self._writer.transact(lambda db: insert(db, CHUNKS, row))
        crash_point("chunk-stored")
        return data

    async def drop_step(self, step_id: str, attempt: int, data: Mapping[str, Json]) -> None:
        """Store that an attempt ended without a result and that its rows were dropped."""
        self._attempts[step_id] = attempt
        await self.event("step-dropped", {"step_id": step_id, "attempt": attempt, **data})

    async def event(self, kind: str, data: Mapping[str, Json] | None = None) -> None:
        """Store something that happened.

        Raises:
            StorageError: storage failed.
        """
        await asyncio.wrap_future(self._submit_event(kind, data or {}))

    def post(self, kind: str, data: Mapping[str, Json]) -> None:
        """Store something that happened, without waiting; a failure goes to `on_failure`."""
        if self.failure is None:
            self._submit_event(kind, data)

    async def prompt(
        self, prompt_id: str, kind: str, text: str, asked_utc: str, answer: str | None, who: str | None
    ) -> None:
        """Store a question and what became of it; answer None means that it stayed unanswered.

        Raises:
            StorageError: storage failed.
        """
        answered_utc = None if answer is None else self._now()
        values = (None, prompt_id, kind, text, asked_utc, answered_utc, answer, who)
        await self._writer.transact(lambda db: insert(db, "prompts", values))

    async def finish(self, status: str, exit_code: int, text: str = "", *, rejected: bool = False) -> None:
        """Write the closing record, seal the directory and release it.

        Args:
            status: how the run ended.
            text: why it did not complete; empty otherwise.
            rejected: what it has stored is no use; it never goes on.

        Raises:
            StorageError: storage has failed, now or before; the run keeps no closing record.
        """
        try:
            closing = {**self._closing(status, exit_code), "text": text, REJECTED: rejected}
            await self.event("run-ended", closing)
            crash_point("closed")
            await self._writer.close(leave_one_file)
            self.wire.close()
            self.log.close()
            await asyncio.to_thread(seal.seal, self.path, self._now())
            crash_point("sealed")
        except OSError as error:
            raise StorageError(f"cannot seal {self.path}: {error}") from error
        finally:
            await self.abandon()

    async def abandon(self) -> None:
        """Release everything without a closing record; may be called any number of times."""
        try:
            await self._writer.close()
        finally:
            self._release()

    def _release(self) -> None:
        self.wire.close()
        self.log.close()
        self._lock.release()

    def _closing(self, status: str, exit_code: int) -> dict[str, Json]:
        return {
            "status": status,
            "exit_code": int(exit_code),
            seal.PROMISED: True,
            "wire_lines_cut": self.wire.cut_lines,
            "wire_bytes_cut": self.wire.cut_bytes,
            "log_lines_cut": self.log.cut_lines,
            HEALS: dict(self.wire.heals),
            "clock_anchor": clock_anchor(self._clock),
        }

    def _submit_event(self, kind: str, data: Mapping[str, Json]) -> "Future[None]":
        values = (None, self._now(), kind, to_json(data))
        return self._writer.submit(lambda db: insert(db, "events", values))

    def _now(self) -> str:
        return self._clock.now_utc().isoformat()

    def _require_running_space(self) -> None:
        try:
            require_space(self.path, int(self._reserve_bytes * _RUNNING_SHARE))
        except (OSError, StorageError) as error:
            raise self._writer.fail(str(error), error) from error

    def _log_failed(self, error: OSError) -> None:
        self._writer.fail(f"cannot write the logs of {self.path}: {error}", error)

    def _storage_failed(self, error: StorageError) -> None:
        self._loop.call_soon_threadsafe(lambda: self.on_failure(error))


def leave_one_file(db: sqlite3.Connection) -> None:
    """Fold the log into the database: one plain file is left for the archive.

    A reader that is just looking may prevent it; then the log file stays beside the database and the manifest covers
    both.
    """
    db.execute("PRAGMA busy_timeout=200")
    db.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchall()
    try:
        db.execute("PRAGMA journal_mode=DELETE").fetchall()
    except sqlite3.OperationalError as error:
        if error.sqlite_errorcode != sqlite3.SQLITE_BUSY:
            raise

"""engine: a process that runs procedures for its clients and outlives them; and how `run --detach` uses one."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import IO, NoReturn, cast

from catseye.app.cli.failure import SEE_WHERE, write_failure_texts
from catseye.app.cli.output import note, write_document, write_line
from catseye.app.errors import OutputError, exit_code_of, text_of, trace_of
from catseye.app.exitcode import ExitCode
from catseye.app.protocol.commands import (
    EngineBegun,
    EngineEnded,
    EngineFailed,
    EngineLine,
    EngineOpened,
    EngineReady,
    engine_line_of,
)
from catseye.app.protocol.message import decode_object
from catseye.app.protocol.requests import AnyRequest, Resume, Start, decode_request, encode_request
from catseye.app.service.address import socket_folder, socket_name
from catseye.app.service.engine_process import EngineProcess
from catseye.app.service.errors import RefusedError


async def serve(
    cell: Path, root: Path, wait_for_client_s: float | None, metrics: Path | None = None
) -> ExitCode:
    """Serve clients until the engine is ended."""

    def ready() -> None:
        path = socket_folder() / socket_name(root)
        _write(EngineReady(socket=str(path), runs=str(root.resolve()), pid=os.getpid()))

    return await EngineProcess(cell, root, metrics).serve(ready, wait_for_client_s)


async def run_once(cell: Path, root: Path, metrics: Path | None = None) -> ExitCode:
    """Run what one line of stdin asks for; say on stdout how that began."""
    engine = EngineProcess(cell, root, metrics)
    try:
        request = _one_request(decode_request(sys.stdin.buffer.readline())[1])
        outcome = await engine.run_once(
            request,
            lambda path: _write(EngineOpened(run=path.name, path=str(path))),
            lambda: _write(EngineBegun()),
        )
    except Exception as error:  # noqa: BLE001  # the starter waits to hear why, whatever it is
        text = trace_of(error) or text_of(error, SEE_WHERE)
        _write(EngineFailed(error=text, exit_code=int(exit_code_of(error))))
        return exit_code_of(error)
    _write(EngineEnded(error=outcome.text, exit_code=int(outcome.exit_code)))
    return outcome.exit_code


def _one_request(request: AnyRequest) -> Start | Resume:
    if not isinstance(request, (Start, Resume)):
        raise RefusedError("an engine that runs once is asked to start or to resume")
    return request


def _write(line: EngineLine) -> None:
    # The engine outlives whoever started it.
    with suppress(OutputError):
        write_document("engine", line.json_object())


def detach(
    request: Start | Resume, cell: Path, root: Path, *, as_json: bool, metrics: Path | None = None
) -> NoReturn:
    """Have an engine of its own session do what a request says; end when its devices are ready.

    Args:
        as_json: the run's path is written as JSON.
        metrics: file that the engine keeps while it runs; None for none.
    """
    arguments = ["engine", "--cell", str(cell.resolve()), "--runs", str(root.resolve()), "--once"]
    if metrics is not None:
        arguments += ["--metrics", str(metrics.resolve())]
    with tempfile.TemporaryFile() as talk:
        process = subprocess.Popen(
            [sys.executable, "-P", "-m", "catseye", *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=talk,
            start_new_session=True,
        )
        try:
            code = _follow(process, encode_request(1, request), lambda line: _heard(line, as_json))
        except KeyboardInterrupt:
            process.terminate()
            raise
        if code is None:
            talk.seek(0)
            said = talk.read().decode(errors="replace").strip()
            code = _as_by_a_shell(process.wait())
            _failed(f"the engine ended with code {code} before the run was open: {said}", code, as_json)
    # The engine runs on without this process; nothing here waits for it.
    process.returncode = process.returncode or 0
    sys.exit(int(code))


def _as_by_a_shell(code: int) -> int:
    """Return the exit code of a process that ought to have said why it ended; a signal counts from 128."""
    return 128 - code if code < 0 else code or ExitCode.FAULT


def _follow(
    process: "subprocess.Popen[bytes]", request: bytes, heard: Callable[[EngineLine], int | None]
) -> int | None:
    """Ask, and listen until it is known how the run began; return the exit code, None when nothing was said."""
    asked, answered = cast(IO[bytes], process.stdin), cast(IO[bytes], process.stdout)
    with answered:
        with suppress(BrokenPipeError), asked:
            asked.write(request)
        for line in answered:
            if (code := heard(engine_line_of(decode_object(line)))) is not None:
                return code
    return None


def _failed(text: str, code: int, as_json: bool) -> None:
    write_failure_texts([text], code)
    if as_json:
        from catseye.app.cli.documents import Failure

        write_document("error", Failure(error=text, exit_code=code).json_object())


def _heard(line: EngineLine, as_json: bool) -> int | None:
    """Pass on what the engine says about its beginning; return the exit code when that is over."""
    match line:
        case EngineOpened():
            if as_json:
                from catseye.app.cli.documents import DetachedRun

                write_document("detached", DetachedRun(run=line.run, path=line.path).json_object())
            else:
                write_line(line.path)
                note(f"it runs on by itself; join it with: catseye attach {line.path}")
        case EngineBegun():
            return 0
        case EngineFailed() | EngineEnded():
            if line.error:
                _failed(line.error, line.exit_code, as_json)
            return line.exit_code
    return None

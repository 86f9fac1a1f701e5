"""engine: a process that runs procedures for its clients and outlives them; and how `run --detach` uses one."""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import IO, Any, NoReturn, cast

from catseye.app.cli.failure import SEE_WHERE, trace_of
from catseye.app.cli.output import emit, emit_json, say
from catseye.app.errors import OutputError, exit_code_of, text_of
from catseye.app.exitcode import ExitCode
from catseye.app.service.address import socket_folder, socket_name
from catseye.app.service.engine_process import EngineProcess
from catseye.app.service.errors import RefusedError
from catseye.app.service.messages import AnyRequest, Resume, Start, decode_request, encode
from catseye.procedures.kit.context import Json


async def serve(cell: Path, root: Path, wait_for_client_s: float | None) -> ExitCode:
    """Serve clients until the engine is ended."""

    def ready() -> None:
        path = socket_folder() / socket_name(root)
        _tell({"event": "engine-ready", "socket": str(path), "runs": str(root.resolve()), "pid": os.getpid()})

    return await EngineProcess(cell, root).serve(ready, wait_for_client_s)


async def run_once(cell: Path, root: Path) -> ExitCode:
    """Run what one line of stdin asks for; say on stdout how that began."""
    engine = EngineProcess(cell, root)
    try:
        request = _one_request(decode_request(sys.stdin.buffer.readline()))
        outcome = await engine.run_once(
            request,
            lambda path: _tell({"event": "opened", "run": path.name, "path": str(path)}),
            lambda: _tell({"event": "ready"}),
        )
    except Exception as error:  # noqa: BLE001  # the starter waits to hear why, whatever it is
        _tell(
            {
                "event": "failed",
                "error": trace_of(error) or text_of(error, SEE_WHERE),
                "exit_code": int(exit_code_of(error)),
            }
        )
        return exit_code_of(error)
    _tell({"event": "ended", "error": outcome.text, "exit_code": int(outcome.exit_code)})
    return outcome.exit_code


def _one_request(request: AnyRequest) -> Start | Resume:
    if not isinstance(request, (Start, Resume)):
        raise RefusedError("an engine that runs once is asked to start or to resume")
    return request


def _tell(value: dict[str, Json]) -> None:
    # The engine outlives whoever started it.
    with suppress(OutputError):
        emit_json(value)


def detach(request: dict[str, Json], cell: Path, root: Path, *, as_json: bool) -> NoReturn:
    """Have an engine of its own session do what a request says; end when its devices are ready.

    Args:
        request: op `start` or `resume`, as on the socket.
        cell: cell file.
        root: folder of all runs.
        as_json: the run's path is told as JSON.
    """
    arguments = ["engine", "--cell", str(cell.resolve()), "--runs", str(root.resolve()), "--once"]
    with tempfile.TemporaryFile() as talk:
        process = subprocess.Popen(
            [sys.executable, "-P", "-m", "catseye", *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=talk,
            start_new_session=True,
        )
        try:
            code = _follow(process, encode({"v": 1, "id": 1, **request}), lambda told: _told(told, as_json))
        except KeyboardInterrupt:
            process.terminate()
            raise
        if code is None:
            talk.seek(0)
            said = talk.read().decode(errors="replace").strip()
            code = _as_by_a_shell(process.wait())
            say(f"the engine ended with code {code} before the run was open: {said}")
    # The engine runs on without this process; nothing here waits for it.
    process.returncode = process.returncode or 0
    sys.exit(int(code))


def _as_by_a_shell(code: int) -> int:
    """Return the exit code of a process that ought to have said why it ended; a signal counts from 128."""
    return 128 - code if code < 0 else code or ExitCode.FAULT


def _follow(
    process: "subprocess.Popen[bytes]", request: bytes, told: Callable[[dict[str, Any]], int | None]
) -> int | None:
    """Ask, and listen until it is known how the run began; return the exit code, None when nothing was said."""
    asked, answered = cast(IO[bytes], process.stdin), cast(IO[bytes], process.stdout)
    with answered:
        with suppress(BrokenPipeError), asked:
            asked.write(request)
        for line in answered:
            if (code := told(json.loads(line))) is not None:
                return code
    return None


def _told(told: dict[str, Any], as_json: bool) -> int | None:
    """Pass on what the engine says about its beginning; return the exit code when that is over."""
    match told["event"]:
        case "opened":
            if as_json:
                emit_json({"run": told["run"], "path": told["path"]})
            else:
                emit(str(told["path"]))
                say(f"it runs on by itself; join it with: catseye attach {told['path']}")
            return None
        case "ready":
            return 0
        case _:
            if told["error"]:
                say(f"catseye: {told['error']}")
            return int(told["exit_code"])

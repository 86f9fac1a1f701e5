"""Which engine `catseye attach` joins where no run is named."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from types import SimpleNamespace

import pytest

from catseye.app.cli import attached
from catseye.app.errors import UsageError
from catseye.app.service.errors import ServiceError

Engines = dict[str, tuple[str | None, str] | None]
"""By socket: run and folder of runs; None for one that answers nobody."""


async def chosen(monkeypatch: pytest.MonkeyPatch, root: Path, engines: Engines) -> Path:
    @asynccontextmanager
    async def connect(path: Path, _program: object) -> AsyncIterator[SimpleNamespace]:
        engine = engines[path.name]
        if engine is None:
            raise ServiceError("nobody listens")
        yield SimpleNamespace(snapshot=SimpleNamespace(path=engine[0], runs=engine[1]))

    monkeypatch.setattr(attached, "all_sockets", lambda: [Path(name) for name in engines])
    monkeypatch.setattr(attached, "connect", connect)
    return await attached.only_engine(root)


async def test_the_only_engine_of_the_folder_is_joined(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    here, elsewhere = tmp_path / "runs", tmp_path / "others"
    engines: Engines = {
        "a": (str(elsewhere / "20260102T030405Z_warmup_abcdef"), str(elsewhere)),
        "b": None,
        "c": (str(here / "20260102T030405Z_warmup_abcdef"), str(here)),
    }
    assert await chosen(monkeypatch, here, engines) == Path("c")


async def test_an_engine_without_a_run_is_joined(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    assert await chosen(monkeypatch, tmp_path, {"a": (None, str(tmp_path))}) == Path("a")


async def test_no_engine_of_another_folder_is_joined(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    engines: Engines = {"a": (None, str(tmp_path / "others")), "b": None}
    with pytest.raises(UsageError, match=f"no engine works in {tmp_path}: start a run"):
        await chosen(monkeypatch, tmp_path, engines)


@pytest.mark.parametrize("runs", [("one", "two"), (None, None)])
async def test_of_several_engines_none_is_guessed(
    runs: tuple[str | None, str | None], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    engines: Engines = {
        str(number): (run and str(tmp_path / run), str(tmp_path)) for number, run in enumerate(runs)
    }
    with pytest.raises(UsageError, match=f"several engines work in {tmp_path}: name one of {tmp_path}"):
        await chosen(monkeypatch, tmp_path, engines)

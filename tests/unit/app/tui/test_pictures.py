"""The process that draws pictures: it answers, dies, is slow, is given up."""

import asyncio
import signal
import sys
from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from catseye.app.tui.pictures import LONGEST_S, PaintingProcess, Pictures, Wanted
from tests.unit.app.engine.fakes import ManualClock

ANSWERS = """
import json, sys
late = []
for line in sys.stdin:
    name = json.loads(line)["path"]
    late.append(json.dumps({"titles": [name], "first": 0, "shown": 1, "lines": [[["█", "in"]]], "note": ""}))
    if name == "dies":
        break
    if name != "slow":
        print(*late, sep="\\n", flush=True)
        late = []
"""
"""Names what it was asked for; what is slow is answered before the next one."""


def wanted(name: str) -> Wanted:
    return Wanted(Path(name), look=True, first=0, width=40, height=10)


@pytest.fixture
async def painter() -> AsyncIterator[PaintingProcess]:
    painter = PaintingProcess((sys.executable, "-c", ANSWERS))
    yield painter
    await painter.close()


async def begun(painter: PaintingProcess, name: str) -> asyncio.Task[Pictures]:
    """Return the drawing of a run, asked for and not answered."""
    drawing: asyncio.Task[Pictures] = asyncio.ensure_future(painter.draw(wanted(name)))
    for _ in range(10):
        await asyncio.sleep(0)
    return drawing


async def test_pictures_are_those_of_the_run_asked_for(painter: PaintingProcess) -> None:
    for name in ("one", "two"):
        pictures = await painter.draw(wanted(name))
        assert (pictures.titles, pictures.shown, pictures.lines) == ((name,), 1, ([("█", "in")],))


async def test_a_process_that_died_is_started_again(painter: PaintingProcess) -> None:
    await painter.draw(wanted("one"))
    pictures = await painter.draw(wanted("dies"))
    assert pictures.titles == ()
    assert "has ended" in pictures.note
    assert (await painter.draw(wanted("two"))).titles == ("two",)


async def test_a_drawing_given_up_is_no_later_answer(painter: PaintingProcess) -> None:
    """As when the screen is closed: nothing is left behind, neither an answer nor a process."""
    await painter.draw(wanted("one"))
    process = painter._process  # noqa: SLF001  # what would be left behind
    assert process is not None
    drawing = await begun(painter, "slow")
    drawing.cancel()
    with pytest.raises(asyncio.CancelledError):
        await drawing
    assert (await painter.draw(wanted("two"))).titles == ("two",)
    assert await process.wait() == -signal.SIGKILL


async def test_others_go_on_while_a_picture_is_slow(painter: PaintingProcess) -> None:
    await painter.draw(wanted("one"))
    drawing = await begun(painter, "slow")
    assert not drawing.done()
    drawing.cancel()
    await asyncio.gather(drawing, return_exceptions=True)


@pytest.mark.parametrize("stopped", [False, True])
async def test_a_painter_that_hangs_is_ended_and_replaced(stopped: bool) -> None:
    """Whether it computes for ever or is stopped by a signal, which no friendly signal ends."""
    clock = ManualClock()
    painter = PaintingProcess((sys.executable, "-c", ANSWERS), clock)
    await painter.draw(wanted("one"))
    process = painter._process  # noqa: SLF001  # what would be left behind
    assert process is not None
    if stopped:
        process.send_signal(signal.SIGSTOP)
    drawing = await begun(painter, "two" if stopped else "slow")
    clock.advance(LONGEST_S - 0.1)
    await asyncio.sleep(0)
    assert not drawing.done()
    clock.advance(0.1)
    pictures = await drawing
    assert (pictures.titles, pictures.failed) == ((), True)
    assert "did not answer for 60 s" in pictures.note
    assert await process.wait() == -signal.SIGKILL
    assert (await painter.draw(wanted("three"))).titles == ("three",)
    await painter.close()


async def test_a_painter_that_does_not_start_is_a_missing_picture() -> None:
    pictures = await PaintingProcess(("/no/such/program",)).draw(wanted("one"))
    assert pictures.failed
    assert "did not start" in pictures.note


async def test_closing_ends_the_process_and_another_drawing_begins_anew(painter: PaintingProcess) -> None:
    await painter.draw(wanted("one"))
    process = painter._process  # noqa: SLF001  # what would be left behind
    await painter.close()
    await painter.close()
    assert process is not None
    assert process.returncode is not None
    assert (await painter.draw(wanted("two"))).titles == ("two",)


async def test_the_real_process_says_why_there_is_no_picture(tmp_path: Path) -> None:
    painter = PaintingProcess()
    pictures = await painter.draw(wanted(str(tmp_path / "no-run")))
    await painter.close()
    assert pictures.titles == ()
    assert "is not a run" in pictures.note

"""What a command reports to the terminal UI that started it, over a real pipe."""

from pathlib import Path

from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.protocol.commands import CommandEvent, CommandFailed
from catseye.app.service.command_process import Commands


async def test_a_failure_comes_whole_with_its_code(tmp_path: Path) -> None:
    cell = tmp_path / "cell.toml"
    cell.write_text(TEMPLATE.replace("[robot]", "[robot]\nunheard_of = 1"), encoding="utf-8")
    done = await Commands().do("config", "validate", cell)
    assert done.code == 2
    [event] = done.events
    assert isinstance(event, CommandFailed)
    assert event.exit_code == 2
    assert done.fault == event.text
    assert "unheard_of" in done.fault
    assert not done.fault.startswith("catseye: ")


async def test_warnings_come_as_they_are_reported(tmp_path: Path) -> None:
    cell = tmp_path / "cell.toml"
    # The robot is not on the machine of the emulated bench, so a door of its own is missed.
    cell.write_text(TEMPLATE.replace("127.0.0.1", "192.0.2.1", 1), encoding="utf-8")
    heard: list[CommandEvent] = []
    done = await Commands().do("config", "validate", cell, heard=heard.append)
    assert done.code == 0
    assert tuple(heard) == done.events
    assert done.warnings
    assert all(f"warning: {text}" in done.talk for text in done.warnings)


async def test_arguments_that_are_not_understood_are_reported_by_stderr() -> None:
    done = await Commands().do("config", "validate", "--unheard-of")
    assert done.code == 2
    assert done.events == ()
    assert "--unheard-of" in done.fault

"""Every cell file to begin with says what becomes of runs that nobody watches, and whom a command tells."""

import tomllib

import pytest

from catseye.app.cell.model import Cell
from catseye.app.cell.templates import TEMPLATES

TEXTS = {f"{system}-{arm}": text for system, one in TEMPLATES.items() for arm, text in one.by_arm.items()}


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS.keys())
def test_every_template_has_engine_and_hooks(text: str) -> None:
    marked = ("# [hooks]", "# on =", "# command =", "# on_output_lost")
    lines = [line.removeprefix("# ") if line.startswith(marked) else line for line in text.splitlines()]
    cell = Cell.model_validate(tomllib.loads("\n".join(lines)))
    assert (cell.engine.on_client_lost, cell.engine.on_output_lost, cell.engine.hold_limit_s) == (
        "hold",
        "go-on",
        900,
    )
    assert cell.hooks.on == ["run-ended", "prompt", "alarm"]

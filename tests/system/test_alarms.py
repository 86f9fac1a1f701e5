"""Alarms of emulated controllers: unmet needs, reset once they were read, or confirmed at the pendant."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from catseye.app.cell.scara.template import TEMPLATE
from tests.system.command import Emulated, catseye, emulated, own_runtime
from tests.system.makes import MAKES

NUMBER = 2600


@contextmanager
def alarmed(folder: Path, text: str = TEMPLATE) -> Iterator[Emulated]:
    """Emulate a bench whose controller is in an alarm."""
    with own_runtime(), emulated(folder, text=text) as bench:
        bench.ask(op="fault", name="alarm", number=NUMBER)
        yield bench


def controller_need(bench: Emulated) -> set[tuple[str, str]]:
    """Return what `procedures` says of the controller, of all procedures together."""
    done = catseye("procedures", "--cell", bench.cell, "--json", cwd=bench.cell.parent)
    assert done.returncode == 0, done.stderr
    entries = [json.loads(line) for line in done.stdout.splitlines()]
    needs = [each["needs"] for each in entries if "needs" in each]
    found = [[need for need in one if need["what"] == "controller"] for one in needs]
    assert all(len(one) == 1 for one in found)
    return {(one[0]["met"], one[0]["text"]) for one in found}


def alarm_of(bench: Emulated) -> int:
    return int(bench.ask(op="arm")["alarm"])


def test_a_melfas_alarm_is_reset_once_read(tmp_path: Path) -> None:
    with alarmed(tmp_path) as bench:
        ((met, text),) = controller_need(bench)
        assert met == "missing"
        assert "2600" in text
        assert "catseye reset-alarm" in text
        for words, code in (([], 2), (["--alarm", "2601"], 5), (["--alarm", "0"], 5)):
            refused = catseye("reset-alarm", bench.cell, *words, cwd=tmp_path)
            assert refused.returncode == code, refused.stderr
            assert "position data outside of the range" in refused.stderr
            assert alarm_of(bench) == NUMBER
        done = catseye("reset-alarm", bench.cell, "--alarm", str(NUMBER), "--json", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert json.loads(done.stdout)["reset"] is True
        assert alarm_of(bench) == 0
        assert controller_need(bench) == {("met", "in no alarm")}
        assert json.loads(catseye("reset-alarm", bench.cell, "--json", cwd=tmp_path).stdout)["reset"] is False


def test_a_run_in_alarm_says_how_it_is_reset(tmp_path: Path) -> None:
    with alarmed(tmp_path) as bench:
        done = catseye("run", "warmup", "--cell", bench.cell, "--speed", "400", cwd=tmp_path)
        assert done.returncode == 5, done.stderr
        assert "position data outside of the range" in done.stderr
        assert "catseye reset-alarm" in done.stderr
        assert not [line for line in bench.ask(op="log", device="robot")["entries"] if "OVRD=" in str(line)]
        assert alarm_of(bench) == NUMBER


@pytest.mark.parametrize("make", MAKES)
def test_alarms_of_other_makes_are_confirmed_at_their_pendant(make: str, tmp_path: Path) -> None:
    with alarmed(tmp_path, MAKES[make].example.read_text(encoding="utf-8")) as bench:
        ((met, text),) = controller_need(bench)
        assert met == "missing"
        assert "reset-alarm" not in text
        refused = catseye("reset-alarm", bench.cell, "--alarm", "1", cwd=tmp_path)
        assert refused.returncode == 5, refused.stderr
        assert "no program resets this" in refused.stderr
        assert alarm_of(bench)
        bench.ask(op="press", key="confirm")
        assert controller_need(bench) == {("met", "in no alarm")}

"""docs/api.md shows the arguments of functions by their names."""

import inspect
import re
from pathlib import Path

import pytest

from catseye import calibration

API = Path(__file__).resolve().parents[2] / "docs" / "api.md"
_CALL = re.compile(r"`(?P<name>[A-Za-z_.]+)\((?P<arguments>[^)`]+)\)`")


def shown() -> list[tuple[str, tuple[str, ...]]]:
    """Return each function or class of the library in the first column of a table, with the arguments shown."""
    rows = (line.split("|")[1] for line in API.read_text("utf-8").splitlines() if line.startswith("| `"))
    calls = (call for row in rows for call in _CALL.finditer(row))
    return [
        (call["name"], tuple(one for one in call["arguments"].split(", ") if one != "…"))
        for call in calls
        if hasattr(calibration, call["name"].partition(".")[0])
    ]


@pytest.mark.parametrize(("name", "arguments"), shown())
def test_arguments_have_the_names_of_the_signature(name: str, arguments: tuple[str, ...]) -> None:
    owner, _, method = name.partition(".")
    function = getattr(calibration, owner)
    names = list(inspect.signature(getattr(function, method) if method else function).parameters)
    assert [one for one in names if one in arguments] == list(arguments)


def test_the_table_has_functions_to_compare() -> None:
    assert len(shown()) > 25

"""XML is parsed in one place, which reads what this program has drawn itself: no file of others can name entities."""

import ast
from pathlib import Path

import pytest

from catseye import app
from catseye.drivers.abb.http import Answer
from catseye.drivers.abb.values import error_of, states_of
from catseye.drivers.roles.errors import ProtocolError

LAUGHS = (
    '<?xml version="1.0"?><!DOCTYPE a [<!ENTITY b0 "ha">'
    + "".join(f'<!ENTITY b{n} "{f"&b{n - 1};" * 10}">' for n in range(1, 30))
    + '<!ENTITY file SYSTEM "file:///etc/passwd">]><a>&b29;&file;</a>'
)


def test_one_module_parses_xml() -> None:
    root = Path(app.__file__).parents[1]
    found = {
        str(path.relative_to(root))
        for room in ("app", "calibration", "drivers", "procedures", "simulators")
        for path in (root / room).rglob("*.py")
        if "xml" in (text := path.read_text("utf-8"))
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Import | ast.ImportFrom)
        for name in (getattr(node, "module", None) or "", *(alias.name for alias in node.names))
        if name.partition(".")[0] in {"xml", "lxml", "defusedxml"}
    }
    # The other one only writes a description of a robot.
    assert found == {"app/render/compact_svg.py", "app/results/serial_arm/export.py"}


def test_a_controller_that_answers_with_entities_is_refused() -> None:
    answer = Answer(200, (("content-type", "application/xhtml+xml"),), LAUGHS.encode())
    with pytest.raises(ProtocolError, match="not JSON"):
        states_of(answer)
    assert error_of(answer) == (200, "")

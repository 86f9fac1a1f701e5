"""Only the SCARA's own rooms know its joints, links and angles by name."""

import re
from pathlib import Path

import pytest

import catseye

ROOT = Path(catseye.__path__[0])

WORDS = re.compile(
    r"(?<![A-Za-z0-9])[Jj][1-4](?![A-Za-z0-9])"  # J1, j4_deg
    r"|[Tt]heta_?[124](?!\d\d)|θ[124]"  # theta1_deg, theta40_deg, θ20
    r"|[Ll]inks?_?[12](?!\d)|\blink [12]\b"  # link1_mm, link 2
    r"|\.\w+\(0\.0, 0\.0, 0\.0, 0\.0\)|\[:, \[0, 1, 3\]\]"  # poses of four, J3 left out
)

ROOMS = ("app", "calibration", "drivers", "procedures")
"""Simulators are a world of their own: they emulate that arm."""

PROTOCOL = "drivers/melfa/"
"""Its axes are named J1 to J8 on the wire."""

LISTED = {
    "app/results/glossary.py": "explains the terms of all systems, those of open-loop tracking among them",
    "app/tui/keys.py": "names the jog's keys, which lie apart for each axis",
    "calibration/__init__.py": "the library's public names, those of the SCARA's models among them",
}
"""Files that name them outside those rooms, and why."""


def is_scaras(path: str) -> bool:
    return "/scara/" in path or path.startswith(PROTOCOL)


def files_with_words() -> set[str]:
    found = set()
    for room in ROOMS:
        for path in (ROOT / room).resolve().rglob("*.py"):
            name = f"{room}/{path.relative_to((ROOT / room).resolve())}"
            if not is_scaras(name) and WORDS.search(path.read_text(encoding="utf-8")):
                found.add(name)
    return found


def test_only_listed_files_name_joints_of_a_scara() -> None:
    assert files_with_words() == LISTED.keys()


@pytest.mark.parametrize(
    "text", ["J1", "j4_deg", "theta40_deg", "θ20", "link1_mm", "link 2", "poses[:, [0, 1, 3]]"]
)
def test_words_of_a_scara_are_found(text: str) -> None:
    assert WORDS.search(text)


@pytest.mark.parametrize("text", ["A1", "axis 1", "J15", "obj1", "links", "theta", "hyperlink 10"])
def test_other_words_are_not_found(text: str) -> None:
    assert not WORDS.search(text)

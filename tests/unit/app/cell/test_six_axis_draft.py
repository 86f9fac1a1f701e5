"""The wizard's cell of a serial arm with a tracker: places of the arm and of the nests."""

import tomllib

import pytest

from catseye.app.cell.model import Cell
from catseye.app.cell.templates import SIX_AXIS, TEMPLATES
from catseye.app.cell.wizard.draft import Draft

ANSWERS = {
    "name": "lab-6",
    "robot.endpoint": "tcp://192.168.125.1:80",
    "tracker.endpoint": "tcp://192.168.0.1:700",
    "tracker.base_mm": "-2000, 100, -400",
    "tracker.base_deg": "0, 0, 90",
    "tracker.nest.0": "-1500, 0, -400",
    "tracker.nest.1": "-1500, 700, -400",
    "tracker.nest.2": "-2200, 700, -400",
}


def filled(**changes: str) -> Draft:
    draft = Draft.new(SIX_AXIS)
    for key, text in {**ANSWERS, **changes}.items():
        draft.give(key, text)
    return draft


def faults(draft: Draft) -> dict[str, str]:
    return draft.faults(lambda _cell: None)


def test_a_new_cell_asks_for_tracker_and_nests() -> None:
    draft = Draft.new(SIX_AXIS)
    assert [page.name for page in draft.pages] == ["file", "robot", "tracker", "ballbar", "more", "summary"]
    assert any("Arm's base, mm" in text for text in draft.to_find_out())
    assert not any("Nest" in text for text in draft.to_find_out())
    assert [text.split(",")[1] for text in draft.left_open()] == [
        f" Nest {number} on the table" for number in (1, 2, 3)
    ]
    assert draft.answer("tracker.base_mm") == ""


def test_answers_make_a_cell_that_is_valid() -> None:
    draft = filled()
    assert faults(draft) == {}
    cell = Cell.model_validate(tomllib.loads(draft.written()[0]))
    assert cell.tracker is not None
    assert [(one.name, one.x_mm, one.y_mm, one.z_mm) for one in cell.tracker.nest] == [
        ("W1", -1500, 0, -400),
        ("W2", -1500, 700, -400),
        ("W3", -2200, 700, -400),
    ]
    assert cell.tracker.base_deg == [0, 0, 90]
    assert cell.tracker.control is None


def test_a_nest_without_an_answer_says_what_is_lost() -> None:
    draft = filled(**{"tracker.nest.2": ""})
    assert (faults(draft), draft.to_find_out()) == ({}, [])
    (text,) = draft.left_open()
    assert text.startswith("Tracker, Nest 3 on the table, mm: ")
    assert "no world frame" in text
    assert not filled().left_open()


def test_drivers_of_trackers_are_explained() -> None:
    draft = Draft.new(SIX_AXIS)
    page = next(page for page in draft.pages if page.name == "tracker")
    (asked,) = (one for one in draft.questions(page) if one.key == "tracker.driver")
    for choice in asked.choices:
        assert str(choice.value) in asked.help
    assert "docs/trackers.md" in asked.help


def test_faults_stand_beside_the_nest() -> None:
    draft = filled(**{"tracker.nest.1": "-1500, far, -400"})
    page = next(page for page in draft.pages if page.name == "tracker")
    assert "tracker.nest.1" in draft.page_faults(page, faults(draft))


def test_a_fault_stands_beside_its_nest_behind_an_unanswered_one() -> None:
    draft = filled(**{"tracker.nest.1": "", "tracker.nest.2": "-2200, far, -400"})
    page = next(page for page in draft.pages if page.name == "tracker")
    found = draft.page_faults(page, faults(draft))
    assert "tracker.nest.2" in found
    assert "tracker.nest.1" not in found


def test_an_added_nest_has_a_name_of_its_own() -> None:
    # The second of three was left unanswered before.
    text = TEMPLATES[SIX_AXIS].text
    head, *nests = text.partition("[ballbar]")[0].split("[[tracker.nest]]")
    draft = Draft.of_text("[[tracker.nest]]".join([head, nests[0], nests[2]]))
    draft.give("tracker.nest.2", "-1450, 650, -330")
    assert faults(draft) == {}
    assert len({nest["name"] for nest in draft.data()["tracker"]["nest"]}) == 3


@pytest.mark.parametrize("typed", ["-1450, 655", "-1450, 655, -330, 7", "here"])
def test_a_nest_wants_three_numbers(typed: str) -> None:
    draft = Draft.of_text(TEMPLATES[SIX_AXIS].text)
    draft.give("tracker.nest.1", typed)
    page = next(page for page in draft.pages if page.name == "tracker")
    assert draft.page_faults(page, faults(draft)) == {"tracker.nest.1": "give three numbers: x, y, z in mm"}


def test_nests_on_a_line_are_refused() -> None:
    draft = filled(**{"tracker.nest.2": "-1500, 1400, -400"})
    page = next(page for page in draft.pages if page.name == "tracker")
    assert "lie on a line" in draft.page_faults(page, faults(draft))["tracker"]


def test_a_file_that_is_there_shows_its_nests() -> None:
    text = TEMPLATES[SIX_AXIS].text
    draft = Draft.of_text(text)
    assert draft.answer("tracker.nest.1") == "-1450.0, 650.0, -330.0"
    draft.give("tracker.nest.1", "-1450, 655, -330")
    assert faults(draft) == {}
    assert [nest["y_mm"] for nest in draft.data()["tracker"]["nest"]] == [-50.0, 655, 650.0]

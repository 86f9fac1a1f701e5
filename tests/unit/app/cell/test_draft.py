"""The wizard's answers: whatever it accepts is a cell file that loads, and what it refuses the model refuses."""

import tomllib
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from catseye.app.cell.load import load_cell
from catseye.app.cell.model import Cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cell.templates import RESOLUTION, SCARA
from catseye.app.cell.wizard.draft import Draft, default_text
from catseye.app.cell.wizard.pages import pages_of
from catseye.app.cell.wizard.question import numbers_of, text_of
from catseye.app.engine.instruments import require_drivers
from catseye.app.errors import ConfigError

PAGE = {page.name: page for page in pages_of(SCARA)}

NEEDED = {
    "name": "lab-7",
    "robot.endpoint": "tcp://192.168.0.20:10001",
    "interferometer.endpoint": "serial:///dev/ttyUSB0?baud=9600&parity=E&stopbits=2",
    "environment.endpoint": "tcp://192.168.0.30:502",
}

TYPED = st.one_of(
    st.sampled_from(
        ["", "yes", "no", "0", "1", "-1", "20", "0.5", "1,5", "nan", "inf", "-30 30", "0 to 90 step 30"]
    ),
    st.sampled_from(["tcp://host:1", "udp://host:1", "serial:///dev/ttyS0", "tcp://host", "#", '"', "a = 1"]),
    st.floats(-400.0, 800.0).map(repr),
    st.text(max_size=6),
)


def answered(more: dict[str, str] | None = None) -> Draft:
    draft = Draft.new()
    for key, text in {**NEEDED, **(more or {})}.items():
        draft.give(key, text)
    return draft


def read_back(text: str) -> Cell:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "cell.toml"
        path.write_text(text, encoding="utf-8")
        return load_cell(path).cell


def test_a_new_file_says_nothing_that_nobody_answered() -> None:
    draft = Draft.new()
    assert draft.faults(require_drivers) == dict.fromkeys(NEEDED, "this key is missing")
    text = "\n".join(draft.to_find_out())
    assert "NETIP" in text
    assert "laser's certificate" not in text
    assert "Pressure register" in text
    assert "Profile" in text


def test_the_needed_answers_give_a_file_with_comments_that_loads() -> None:
    draft = answered()
    assert draft.faults(require_drivers) == {}
    text, commented = draft.written()
    cell = read_back(text)
    assert commented
    assert "# the program never drives faster" in text
    assert cell.name == "lab-7"
    assert cell.robot.endpoint == NEEDED["robot.endpoint"]
    assert cell.tracker is None
    assert cell.environment is not None
    assert cell.environment.pressure_register is None
    assert cell.interferometer is not None
    assert cell.interferometer.profile is None


def test_faults_are_the_models_own_words() -> None:
    draft = answered({"optics.max_miss_mm": "2", "robot.link1_mm": "long", "robot.limits_deg.j1": "10 -10"})
    data = draft.data()
    with pytest.raises(ValueError, match="has to be below acceptance_mm"):
        Cell.model_validate(data)
    faults = draft.faults(require_drivers)
    assert faults["robot.link1_mm"] == "Input should be a valid number, not 'long'"
    assert faults["robot.limits_deg.j1"] == "the lower limit 10 has to be below the upper limit -10"
    assert draft.page_faults(PAGE["optics"], faults).keys() == {"optics"}
    assert draft.page_faults(PAGE["robot"], faults).keys() == {"robot.link1_mm", "robot.limits_deg.j1"}


def test_a_high_cap_is_asked_for_its_reason() -> None:
    draft = answered()
    reason = "robot.override_cap_reason"
    assert reason not in [question.key for question in draft.questions(PAGE["robot"])]
    draft.give("robot.override_cap_percent", "45")
    assert reason in [question.key for question in draft.questions(PAGE["robot"])]
    assert "say why in override_cap_reason" in draft.faults(require_drivers)["robot"]
    draft.give(reason, "empty cell")
    assert draft.faults(require_drivers) == {}
    assert read_back(draft.written()[0]).robot.override_cap_reason == "empty cell"


def test_driver_settings_are_asked_and_validated_by_the_drivers_model() -> None:
    draft = answered({"interferometer.driver": "attocube-ids"})
    draft.give("interferometer.endpoint", "tcp://192.168.1.1:9090")
    keys = [question.key for question in draft.questions(PAGE["interferometer"])]
    assert "interferometer.settings.dialect" in keys
    assert "interferometer.profile" not in keys
    draft.give("interferometer.settings.axis", "7")
    assert "less than or equal to 2" in draft.faults(require_drivers)["interferometer.settings.axis"]
    draft.give("interferometer.settings.axis", "2")
    assert draft.faults(require_drivers) == {}
    assert read_back(draft.written()[0]).instruments["interferometer"].settings == {"axis": 2}


def test_another_driver_begins_without_the_settings_of_the_one_before() -> None:
    draft = answered({"interferometer.driver": "attocube-ids", "interferometer.settings.axis": "2"})
    draft.give("interferometer.driver", "heidenhain-nd")
    assert draft.data()["interferometer"].get("settings", {}) == {}


def test_optional_sections_come_and_go() -> None:
    draft = answered({"io": "yes", "io.endpoint": "tcp://192.168.0.40:502", "material": "yes"})
    for key, text in {
        "material.sensor": "links",
        "material.device.driver": "modbus-air",
        "material.device.endpoint": "tcp://192.168.0.50:502",
        "material.cte_per_k": "11.5e-6",
    }.items():
        draft.give(key, text)
    assert draft.faults(require_drivers) == {}
    cell = read_back(draft.written()[0])
    assert cell.io is not None
    assert cell.material is not None
    assert [(one.name, one.endpoint) for one in cell.device] == [("links", "tcp://192.168.0.50:502")]
    again = Draft.of_text(draft.written()[0])
    assert again.answer("material.device.endpoint") == "tcp://192.168.0.50:502"
    again.give("io", "no")
    assert read_back(again.written()[0]).io is None


def test_reflectors_are_added_and_removed() -> None:
    draft = answered()
    del draft.reflectors[1]
    draft.reflectors.append({"name": "P9", "x_mm": "100", "y_mm": "far", "facing_deg": ""})
    assert draft.page_faults(PAGE["reflector"], draft.faults(require_drivers)).keys() == {"reflector.2.y_mm"}
    draft.reflectors[-1]["y_mm"] = "-700"
    cell = read_back(draft.written()[0])
    assert [(r.name, r.x_mm, r.y_mm) for r in cell.reflector] == [
        ("P1", 650.0, -400.0),
        ("P3", 640.0, 380.0),
        ("P9", 100.0, -700.0),
    ]


def test_a_file_with_faults_can_be_opened_and_mended() -> None:
    draft = Draft.of_text(TEMPLATE.replace("link1_mm = 325.0 ", "link1_mm = -3    "))
    assert set(draft.faults(require_drivers)) == {"robot.link1_mm"}
    draft.give("robot.link1_mm", "325")
    assert draft.text() == TEMPLATE.replace(
        "link1_mm = 325.0                        #", "link1_mm = 325                          #"
    )
    with pytest.raises(ConfigError, match="not a cell file"):
        Draft.of_text("a = 1\n")


def test_the_templates_own_values_are_left_byte_for_byte() -> None:
    draft = Draft.of_text(TEMPLATE)
    for page in pages_of(SCARA):
        for question in draft.questions(page):
            if question.key != "file":
                draft.give(question.key, draft.answer(question.key))
    assert draft.text() == TEMPLATE


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("-140 to 60 step 20", [-140.0 + 20.0 * i for i in range(11)]),
        ("0 to 1 step 0.1", [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]),
        ("-140, -120; 0", [-140, -120, 0]),
        ("[1.5 2]", [1.5, 2]),
        ("1 to 0 step 1", "1 to 0 step 1"),
        ("0 to 1e9 step 1e-3", "0 to 1e9 step 1e-3"),
    ],
)
def test_numbers_as_they_are_typed(typed: str, meant: object) -> None:
    assert numbers_of(typed) == meant


@given(st.lists(st.floats(-400.0, 400.0) | st.integers(-400, 400), min_size=1, max_size=8))
def test_numbers_are_typed_as_they_are_read(values: list[float]) -> None:
    assert numbers_of(text_of(values)) == values


def test_defaults_are_those_of_the_model() -> None:
    assert default_text("robot.override_cap_percent") == "20.0"
    assert default_text("robot.endpoint") == ""
    assert default_text("io.driver") == "modbus-io"


@settings(max_examples=120)
@given(st.data())
def test_whatever_the_wizard_accepts_loads(data: st.DataObject) -> None:
    draft = answered()
    for _ in range(data.draw(st.integers(1, 5))):
        page = data.draw(st.sampled_from([page for page in pages_of(SCARA) if page.questions(draft.answer)]))
        question = data.draw(st.sampled_from(draft.questions(page)))
        if question.choices:
            draft.give(question.key, data.draw(st.sampled_from(question.choices)).text)
        else:
            draft.give(question.key, data.draw(TYPED))
    if data.draw(st.booleans()):
        draft.reflectors.append(
            {"name": data.draw(TYPED), "x_mm": data.draw(TYPED), "y_mm": "1", "facing_deg": ""}
        )
    text, _ = draft.written()
    if draft.faults(require_drivers):
        return
    assert read_back(text) == Cell.model_validate(draft.data())
    assert tomllib.loads(text) == draft.data()


NEEDED_OF_RESOLUTION = {**NEEDED, "angular_optics.spacing_mm": "30.0"}


def of_resolution(more: dict[str, str] | None = None) -> Draft:
    draft = Draft.new()
    draft.give("system", RESOLUTION)
    for key, text in {**NEEDED_OF_RESOLUTION, **(more or {})}.items():
        draft.give(key, text)
    return draft


def test_a_cell_of_motion_resolution_asks_for_its_own() -> None:
    draft = Draft.new()
    draft.give("system", RESOLUTION)
    assert draft.faults(require_drivers) == dict.fromkeys(NEEDED_OF_RESOLUTION, "this key is missing")
    assert [page.name for page in draft.pages] == [
        "file",
        "robot",
        "interferometer",
        "environment",
        "angular_optics",
        "more",
        "summary",
    ]  # fmt: skip - a list
    assert "certificate of the angular optics" in "\n".join(draft.to_find_out())


def test_answers_of_motion_resolution_become_a_cell() -> None:
    cell = read_back(of_resolution({"robot.limits_deg.a1": "-90, 90"}).text())
    assert (cell.robot.driver, cell.robot.arm) == ("kuka-varproxy", "kr210-r2700")
    assert cell.angular_optics is not None
    assert cell.angular_optics.spacing_mm == 30.0
    assert cell.robot.limits_deg.model_dump(exclude_unset=True)["a1"] == [-90.0, 90.0]
    assert cell.reflector == []


def test_limits_are_asked_for_the_axes_of_the_arm() -> None:
    draft = of_resolution()
    page = next(page for page in draft.pages if page.name == "robot")

    def limits() -> list[str]:
        keys = [question.key for question in draft.questions(page)]
        return [key.rpartition(".")[2] for key in keys if key.startswith("robot.limits_deg.")]

    assert limits() == ["a1", "a2", "a3", "a4", "a5", "a6"]
    draft.give("robot.arm", "no-such-arm")
    assert limits() == []
    assert "no-such-arm" in str(draft.faults(require_drivers))


def test_another_system_keeps_the_file_and_its_name() -> None:
    draft = answered({"file": "my.toml"})
    draft.give("system", RESOLUTION)
    assert (draft.answer("file"), draft.answer("name"), draft.answer("robot.endpoint")) == (
        "my.toml",
        NEEDED["name"],
        "",
    )


def test_a_file_that_is_there_keeps_its_system() -> None:
    draft = Draft.of_text(of_resolution().text())
    assert draft.system == RESOLUTION
    first = draft.pages[0]
    assert "system" not in [question.key for question in draft.questions(first)]
    draft.give("system", SCARA)
    assert draft.system == RESOLUTION


def test_faults_of_linear_optics_stand_on_the_page_of_optics() -> None:
    draft = of_resolution({"linear_optics.signal_min": "2"})
    faults = draft.faults(require_drivers)
    page = next(page for page in draft.pages if page.name == "angular_optics")
    assert list(draft.page_faults(page, faults)) == ["linear_optics.signal_min"]

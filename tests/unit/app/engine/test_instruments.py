"""Settings of a cell file reach the drivers, or are reported to be wrong."""

import tomllib
from pathlib import Path
from typing import Any

import pytest

from catseye.app.cell.model import Cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cli.doctor import doctor
from catseye.app.engine.instruments import device_builder, stop_request
from catseye.app.errors import ConfigError
from catseye.drivers.roles.clock import SystemClock


def cell(**sections: dict[str, Any]) -> Cell:
    """Return the template's cell with some keys of its sections changed."""
    given = tomllib.loads(TEMPLATE)
    return Cell.model_validate(
        {**given, **{name: {**given[name], **keys} for name, keys in sections.items()}}
    )


@pytest.mark.parametrize(
    ("sections", "said"),
    [
        (
            {"interferometer": {"profile": None, "settings": {"profile": 5}}},
            r"\[interferometer\] profile: .*string",
        ),
        ({"interferometer": {"settings": {"quiet_s": "long"}}}, r"\[interferometer\] quiet_s: .*number"),
        (
            {"interferometer": {"settings": {"profil": "vacuum"}}},
            r"\[interferometer\] profil: unknown setting; did you mean 'profile'\? line-counter knows ",
        ),
        (
            {"robot": {"settings": {"colour": 1}}},
            r"\[robot\] colour: unknown setting; melfa-r3 knows answer_timeout_s",
        ),
        (
            {"interferometer": {"driver": "norra-ld5"}},
            r"\[interferometer\] driver: no driver 'norra-ld5' is installed",
        ),
        (
            {"interferometer": {"profile": "default", "settings": {"profile": "vacuum"}}},
            "profile is set .* and in",
        ),
        (
            {"environment": {"map": "vaisala", "settings": {"map": "generic"}}},
            "map is set in the section and in",
        ),
        ({"environment": {"settings": {"endpoint": "tcp://10.0.0.1:502"}}}, "endpoint is not a setting"),
    ],
)
def test_wrong_settings_are_reported_in_a_sentence(sections: dict[str, dict[str, Any]], said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        device_builder(cell(**sections), SystemClock())


def test_a_further_devices_wrong_setting_is_reported_before_connecting(tmp_path: Path) -> None:
    file = tmp_path / "cell.toml"
    display = (
        'name = "nd"\ndriver = "heidenhain-nd"\nendpoint = "tcp://127.0.0.1:9"\nsettings = {decimals = 9}\n'
    )
    file.write_text(f"{TEMPLATE}\n[[device]]\n{display}", encoding="utf-8")
    # Warnings are errors here: no examination may be left unawaited.
    with pytest.raises(ConfigError, match=r"\[nd\] decimals"):
        doctor(file, None, as_json=False)


@pytest.mark.parametrize("driver", ["melfa-r3", "melfa-mxt", "melfa-datalink"])
def test_an_arm_is_stopped_with_the_settings_of_its_cell(driver: str) -> None:
    settings = {"robot_number": 2, "slot": 3, "stop_endpoint": "tcp://192.168.0.20:10002"}
    assert stop_request(driver, "robot", settings) == b"\r2;3;STOP\r"


def test_a_device_without_a_word_for_it_is_not_stopped() -> None:
    assert stop_request("line-counter", "second", {}) is None


def test_wrong_settings_stop_nothing() -> None:
    with pytest.raises(ConfigError, match=r"\[second\] slot"):
        stop_request("melfa-r3", "second", {"slot": 99})

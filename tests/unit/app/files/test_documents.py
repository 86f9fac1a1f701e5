"""Files that a user names are regular, of bounded size, and every fault in them is named."""

import os
import socket
from collections.abc import Callable
from pathlib import Path

import pytest

from catseye.app.cell.load import load_cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.errors import CatseyeError, ConfigError, exit_code_of
from catseye.app.exitcode import ExitCode
from catseye.app.files.documents import parse_json, parse_toml, read_document
from catseye.app.results.scara.result import read_result
from catseye.app.service.running import read_answers
from catseye.app.tui.keys import read_keymap
from catseye.drivers.counter.profile import load_profile
from catseye.drivers.roles.errors import ProfileError
from catseye.drivers.roles.user_file import LARGEST_BYTES
from catseye.simulators.errors import EmulatorError

READERS: dict[str, Callable[[Path], object]] = {
    "cell": load_cell,
    "answers": read_answers,
    "result": read_result,
    "keys": read_keymap,
    "profile": lambda path: load_profile(str(path)),
}
REFUSALS = (CatseyeError, ProfileError, EmulatorError)


def _fifo(folder: Path) -> Path:
    path = folder / "fifo"
    os.mkfifo(path)
    return path


def _socket(folder: Path) -> Path:
    path = folder / "socket"
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(path))
    return path


STRANGE: dict[str, Callable[[Path], Path]] = {
    "is a device": lambda _folder: Path("/dev/zero"),
    "is a pipe": _fifo,
    "is a folder": lambda folder: folder,
    "is a socket": _socket,
}


@pytest.mark.parametrize("read", READERS.values(), ids=READERS)
@pytest.mark.parametrize("kind", STRANGE)
def test_what_is_no_regular_file_is_named(tmp_path: Path, kind: str, read: Callable[[Path], object]) -> None:
    with pytest.raises(REFUSALS, match=kind) as caught:
        read(STRANGE[kind](tmp_path))
    assert exit_code_of(caught.value) is ExitCode.USAGE


@pytest.mark.parametrize("read", [read for name, read in READERS.items() if name != "result"])
def test_a_file_beyond_four_megabytes_is_refused(tmp_path: Path, read: Callable[[Path], object]) -> None:
    path = tmp_path / "long.toml"
    path.write_bytes(b"#" * (LARGEST_BYTES + 1))
    with pytest.raises(REFUSALS, match="larger than 4096 KiB"):
        read(path)


def test_a_file_of_just_four_megabytes_is_read(tmp_path: Path) -> None:
    path = tmp_path / "long.toml"
    path.write_bytes(b"#" * LARGEST_BYTES)
    assert len(read_document(path)) == LARGEST_BYTES


def test_a_file_without_a_size_is_bounded_too() -> None:
    with pytest.raises(ConfigError, match="larger than"):
        read_document(Path("/proc/self/maps"), largest_bytes=10)


@pytest.mark.parametrize("name", ["a\0b", "x" * 5000, "\udc80/../\0"])
def test_a_name_that_no_file_can_have_is_refused(name: str) -> None:
    with pytest.raises(ConfigError):
        read_document(Path(name))


@pytest.mark.parametrize("number", ["9" * 5000, "-" + "9" * 5000, "9" * 30, "0x" + "f" * 5000])
def test_a_long_integer_in_toml_is_named(number: str) -> None:
    with pytest.raises(ConfigError, match=r"cell\.toml: an integer is too long"):
        parse_toml(f"a = [{{b = {number}}}]", "cell.toml")


@pytest.mark.parametrize("number", ["9" * 5000, "-" + "9" * 5000, "9" * 20])
def test_a_long_integer_in_json_is_named(number: str) -> None:
    with pytest.raises(ConfigError, match="an integer is too long"):
        parse_json(f'{{"a": [{number}]}}', "truth.json")


def test_integers_of_64_bits_are_kept() -> None:
    assert parse_toml(f"a = {2**63 - 1}", "x") == {"a": 2**63 - 1}
    assert parse_json(f"[{1 - 2**63}]", "x") == [1 - 2**63]


@pytest.mark.parametrize("deep", ["a = " + "[" * 100_000, "a = " + "[" * 100_000 + "]" * 100_000])
def test_toml_that_is_nested_too_deeply_is_named(deep: str) -> None:
    with pytest.raises(ConfigError, match="nested too deeply"):
        parse_toml(deep, "cell.toml")


def test_json_that_is_nested_too_deeply_is_named() -> None:
    with pytest.raises(ConfigError, match="nested too deeply"):
        parse_json("[" * 100_000, "truth.json")


@pytest.mark.parametrize("read", READERS.values(), ids=READERS)
@pytest.mark.parametrize("text", ["a = " + "9" * 5000, "a = " + "[" * 100_000, '{"a": ' + "9" * 5000 + "}"])
def test_hostile_values_are_named_by_every_reader(
    tmp_path: Path, text: str, read: Callable[[Path], object]
) -> None:
    path = tmp_path / "hostile"
    path.write_text(text)
    with pytest.raises(REFUSALS, match="hostile") as caught:
        read(path)
    assert exit_code_of(caught.value) is ExitCode.USAGE


def test_a_cell_with_a_long_integer_is_named(tmp_path: Path) -> None:
    path = tmp_path / "cell.toml"
    path.write_text(TEMPLATE.replace("override_cap_percent = 20", "override_cap_percent = " + "9" * 5000))
    with pytest.raises(ConfigError, match=r"cell\.toml: an integer is too long"):
        load_cell(path)


def test_thousands_of_faults_are_reported_in_few_lines(tmp_path: Path) -> None:
    path = tmp_path / "cell.toml"
    path.write_text("".join(f"key{number} = 1\n" for number in range(5000)))
    with pytest.raises(ConfigError, match="further faults") as caught:
        load_cell(path)
    assert str(caught.value).count("\n") < 60


@pytest.mark.parametrize("constant", ["NaN", "Infinity", "-Infinity"])
def test_json_with_what_is_no_number_is_refused(constant: str) -> None:
    with pytest.raises(ConfigError, match=f"{constant} is not a JSON number"):
        parse_json(f'{{"link1_mm": {constant}}}', "truth.json")

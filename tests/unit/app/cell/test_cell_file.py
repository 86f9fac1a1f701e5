"""The cell file: what it accepts, and what it says about what it does not."""

from pathlib import Path

import pytest

from catseye.app.cell.bench import scara_bench_of
from catseye.app.cell.load import load_cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.errors import ConfigError


def written(folder: Path, text: str) -> Path:
    path = folder / "cell.toml"
    path.write_text(text, encoding="utf-8")
    return path


def fault(folder: Path, old: str, new: str) -> str:
    assert old in TEMPLATE
    with pytest.raises(ConfigError) as caught:
        load_cell(written(folder, TEMPLATE.replace(old, new, 1)))
    return str(caught.value)


def test_template_is_the_papers_layout(tmp_path: Path) -> None:
    loaded = load_cell(written(tmp_path, TEMPLATE))
    bench = scara_bench_of(loaded.cell)
    assert len(bench.nodes1_deg) * 2 * len(bench.nodes2_deg) * 2 == 352
    places = [(r.name, r.x_mm, r.y_mm) for r in bench.reflectors]
    assert places == [("P1", 650.0, -400.0), ("P2", 680.0, 0.0), ("P3", 640.0, 380.0)]
    assert bench.reflectors[1].facing_deg == pytest.approx(180.0)
    assert (bench.link1_mm, bench.link2_mm) == (325.0, 225.0)


def test_origin_of_every_value(tmp_path: Path) -> None:
    origins = load_cell(written(tmp_path, TEMPLATE)).origins
    assert origins["robot.link1_mm"] == "file"
    assert origins["robot.speed_deg_s"] == "default"
    assert origins["reflector[2].x_mm"] == "file"
    assert origins["reflector[2].facing_deg"] == "default"


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("link1_mm", "link1_m", ["robot.link1_m: unknown key; did you mean link1_mm?"]),
        ("settle_time_s", "settle_time", ["unknown key; did you mean settle_time_s?"]),
        ("acceptance_mm = 1.0", "acceptance_mm = true", ["optics.acceptance_mm", "True"]),
        ("acceptance_mm = 1.0", "acceptance_mm = nan", ["optics.acceptance_mm", "finite"]),
        ("max_miss_mm = 0.2", "max_miss_mm = 1.5", ["has to be below acceptance_mm"]),
        ("-120.0", "-145.0", ["measurement.theta1_deg", "nodes have to increase strictly; -145 follows -140"]),
        ('name = "P2"', 'name = "P1"', ["two reflectors are called P1"]),
        ("override_cap_percent = 20", "override_cap_percent = 120", ["override_cap_percent", "100"]),
        ("j1 = [-170.0, 170.0]", "j1 = [170.0, -170.0]", ["robot.limits_deg.j1", "below the upper limit"]),
        ("j2 = [-145.0, 145.0]", "j9 = [-1.0, 1.0]", ["limits_deg.j9", "turns no joint J9; it turns j1, j2, j4"]),
        ("j2 = [-145.0, 145.0]", "j3 = [-1.0, 1.0]", ["limits_deg.j3", "turns no joint J3"]),
        ("tcp://127.0.0.1:10001", "127.0.0.1:10001", ["robot.endpoint", "tcp://host:port"]),
        ('"catseye-cell/1"', '"catseye-cell/2"', ["format", "catseye-cell/1"]),
        ("x_mm = 680.0\n", "", ["reflector[2].x_mm: this key is missing"]),
        ('name = "lab-1"', 'name = "lab 1"', ["name"]),
    ],
)  # fmt: skip
def test_fault_names_the_key_and_the_remedy(tmp_path: Path, old: str, new: str, expected: list[str]) -> None:
    text = fault(tmp_path, old, new)
    for part in expected:
        assert part in text


def test_fault_names_the_line(tmp_path: Path) -> None:
    line = next(i for i, row in enumerate(TEMPLATE.splitlines(), 1) if row.startswith("take_up_deg"))
    assert f"cell.toml:{line}: measurement.take_up_deg" in fault(
        tmp_path, "take_up_deg = 1.0", "take_up_deg = 0.0"
    )


def test_fault_in_the_second_reflector_names_its_line(tmp_path: Path) -> None:
    line = next(i for i, row in enumerate(TEMPLATE.splitlines(), 1) if row.startswith("x_mm = 680.0"))
    assert f"cell.toml:{line}: reflector[2].x_mm" in fault(tmp_path, "x_mm = 680.0", 'x_mm = "680"')


def test_missing_file_names_the_remedy(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="catseye init"):
        load_cell(tmp_path / "absent.toml")


def test_not_toml_names_the_place(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"not a TOML file.*line 1"):
        load_cell(written(tmp_path, "= 3"))


def test_byte_order_mark_is_passed_over(tmp_path: Path) -> None:
    path = written(tmp_path, TEMPLATE)
    plain = load_cell(path).cell
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert load_cell(path).cell == plain


def test_binary_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "cell.toml"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ConfigError, match=r"not in UTF-8.*save it as UTF-8 text"):
        load_cell(path)


def test_a_contributor_without_a_name_is_one_fault(tmp_path: Path) -> None:
    path = tmp_path / "cell.toml"
    path.write_text(TEMPLATE.replace('name = "wavelength"', "", 1), encoding="utf-8")
    with pytest.raises(ConfigError) as refused:
        load_cell(path)
    (fault,) = str(refused.value).splitlines()[1:]
    assert fault.endswith("name: this key is missing")


def test_a_long_value_is_shown_in_part(tmp_path: Path) -> None:
    path = tmp_path / "cell.toml"
    path.write_text(TEMPLATE.replace("tcp://127.0.0.1:10001", "x" * 100_000), "utf-8")
    with pytest.raises(ConfigError, match=r"cell\.toml:\d+: robot\.endpoint: .*…") as caught:
        load_cell(path)
    assert len(str(caught.value)) < 2000

"""[uncertainty]: the list of contributors, Table 2 as its default, and the totals of earlier files."""

import math
import tomllib
from pathlib import Path

import pytest

from catseye.app.cell.load import load_cell
from catseye.app.cell.model import Cell
from catseye.app.cell.plausible import implausible
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cell.scara.uncertainty import PAPER_WAVELENGTH_PPM, Uncertainty, table_2
from catseye.app.cell.section import RECORD
from catseye.app.errors import ConfigError

HEAD = TEMPLATE[: TEMPLATE.index("# The error budget")]


def loaded(tmp_path: Path, section: str) -> Cell:
    file = tmp_path / "cell.toml"
    file.write_text(HEAD + section, encoding="utf-8")
    return load_cell(file).cell


def test_the_template_states_the_default() -> None:
    assert Cell.model_validate(tomllib.loads(TEMPLATE)).uncertainty == Uncertainty()


def test_the_default_is_table_2() -> None:
    found = {one.name: one for one in Uncertainty().budget.contributors}
    assert found["repeatability of the robot"].u == pytest.approx(0.010)
    assert [found[f"radial error motion of {axis}"].u for axis in ("J1", "J2", "J4")] == pytest.approx(
        [0.005, 0.005, 0.010]
    )
    # 0.04 and 0.19 µm in the example's distance from (100, 100) to (650, -400) mm.
    distance_mm = math.hypot(550.0, 500.0)
    paper = {one.name: one.contributor() for one in table_2(wavelength_ppm=PAPER_WAVELENGTH_PPM)}
    assert paper["wavelength"].u * distance_mm == pytest.approx(0.04e-3, rel=0.01)
    assert found["wavelength correction"].u * distance_mm == pytest.approx(0.19e-3, rel=0.01)
    assert found["beam direction, J1"].u == pytest.approx(7.17e-4)


def test_the_default_laser_is_as_good_as_its_wavelength() -> None:
    # Stone et al., Metrologia 46 (2009) 11: 632.9908 nm with a relative standard uncertainty of 1.5e-6.
    cell = Cell.model_validate(tomllib.loads(TEMPLATE))
    assert cell.air.vacuum_wavelength_nm == 632.9908
    (laser,) = (one for one in cell.uncertainty.budget.contributors if one.name == "wavelength")
    assert laser.u == pytest.approx(1.5e-6)
    assert laser.correlation == "common"


@pytest.mark.parametrize(
    ("key", "value", "doubted"),
    [
        ("value_ppm", "1.5", False),
        ("value_ppm", "0.054", True),
        ("vacuum_wavelength_nm", "632.9914", False),
    ],
)
def test_a_sure_scale_beside_any_laser_is_doubted(key: str, value: str, doubted: bool) -> None:
    text = TEMPLATE.replace("value_ppm = 1.5", f"value_ppm = {value if key == 'value_ppm' else '0.054'}")
    if key != "value_ppm":
        text = text.replace(f"{key} = 632.9908", f"{key} = {value}")
    doubts = implausible(Cell.model_validate(tomllib.loads(text)))
    assert any("is that of any helium-neon laser, good to 1.5 ppm" in one for one in doubts) is doubted


def test_totals_of_earlier_files_map_to_current_contributors(tmp_path: Path) -> None:
    section = (
        "[uncertainty]\nrepeatability_um = 8.0\nlaser_um = 0.5\nradial_j4_um = 12.0\nradial_orders = 3\n"
    )
    found = loaded(tmp_path, section).uncertainty
    assert found.white_um == pytest.approx(math.hypot(8.0, 0.5, 0.31))
    assert [found.radial_um(axis) for axis in ("j1", "j2", "j4")] == pytest.approx([5.0, 5.0, 12.0])
    assert found.radial_orders == 3


@pytest.mark.parametrize(
    ("distribution", "divisor"),
    [("normal", 1.0), ("uniform", math.sqrt(3)), ("triangular", math.sqrt(6)), ("arcsine", math.sqrt(2))],
)
def test_half_widths_become_standard_uncertainties(tmp_path: Path, distribution: str, divisor: float) -> None:
    line = f'value_um = 6.0\ndistribution = "{distribution}"\n'
    section = f'[[uncertainty.contributor]]\nname = "c"\nkind = "length"\n{line}'
    (one,) = loaded(tmp_path, section).uncertainty.budget.contributors
    assert one.u == pytest.approx(0.006 / divisor)


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ('kind = "length"\nvalue_ppm = 1.0', "kind length is stated by value_um, not by value_ppm"),
        ('kind = "length"', "kind length is stated by value_um, not by nothing"),
        ('kind = "scale"\nvalue_ppm = 1.0\ncorrelation = "pose"', "cannot be correlated per pose"),
        ('kind = "radial"\nvalue_um = 1.0\ncorrelation = "axis-angle"', "say which axis"),
        ('kind = "length"\nvalue_um = -1.0', "greater than or equal to 0"),
        ('kind = "length"\nvalue_um = 1.0\nsigma = 2.0', "unknown key"),
    ],
)
def test_a_wrong_line_is_refused_with_its_place(tmp_path: Path, line: str, complaint: str) -> None:
    with pytest.raises(ConfigError) as caught:
        loaded(tmp_path, f'[[uncertainty.contributor]]\nname = "c"\n{line}\n')
    assert complaint in str(caught.value)
    first = HEAD.count("\n") + 1
    lines = [int(part.split(":")[0]) for part in str(caught.value).split("cell.toml:")[1:]]
    assert all(first <= number <= first + 5 for number in lines)


SPECTRUM = """
[[uncertainty.contributor]]
name = "run-out"
kind = "radial"
value_um = 5.0
correlation = "axis-angle"
axis = "j1"
orders = 2
spectrum = [0.5, 1.5]
"""


def test_a_spectrum_is_a_list_of_numbers(tmp_path: Path) -> None:
    (one,) = loaded(tmp_path, SPECTRUM).uncertainty.budget.contributors
    assert one.spectrum == (0.5, 1.5)
    cell = Cell.model_validate(tomllib.loads(HEAD + SPECTRUM), context=RECORD)
    assert cell.uncertainty.contributor[0].spectrum == (0.5, 1.5)
    with pytest.raises(ConfigError, match="spectrum"):
        loaded(tmp_path, SPECTRUM.replace("1.5]", '"1.5"]'))


TWICE = """
[[uncertainty.contributor]]
name = "radial"
kind = "radial"
value_um = 5.0
correlation = "axis-angle"
axis = "j1"

[[uncertainty.contributor]]
name = "radial"
kind = "radial"
value_um = 10.0
correlation = "axis-angle"
axis = "j4"
"""


def test_a_name_that_occurs_twice_is_refused(tmp_path: Path) -> None:
    with pytest.raises(
        ConfigError, match="more than one contributor named radial: give each a name of its own"
    ):
        loaded(tmp_path, TWICE)


def test_runs_whose_contributors_share_a_name_are_read() -> None:
    cell = Cell.model_validate(tomllib.loads(HEAD + TWICE), context=RECORD)
    assert [one.name for one in cell.uncertainty.contributor] == ["radial", "radial"]


@pytest.mark.parametrize(("kind", "orders"), [("length", 31), ("links", 3)])
def test_what_changes_with_time_has_usual_orders(tmp_path: Path, kind: str, orders: int) -> None:
    value = "value_ppm" if kind == "links" else "value_um"
    section = (
        f'[[uncertainty.contributor]]\nname = "c"\nkind = "{kind}"\n{value} = 3.0\ncorrelation = "time"\n'
    )
    (one,) = loaded(tmp_path, section).uncertainty.budget.contributors
    assert one.orders == orders
    assert one.u == pytest.approx(3e-6 if kind == "links" else 3e-3)


def test_an_angle_takes_few_orders_only(tmp_path: Path) -> None:
    section = (
        '[[uncertainty.contributor]]\nname = "c"\nkind = "radial"\nvalue_um = 3.0\n'
        'correlation = "axis-angle"\naxis = "j1"\norders = 31\n'
    )
    with pytest.raises(ConfigError, match="up to 20 orders"):
        loaded(tmp_path, section)

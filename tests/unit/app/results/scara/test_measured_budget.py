"""Measured radial error motions in a cell file: these lines and no others, with the run that measured them."""

import tomllib
from pathlib import Path
from typing import Any, cast

import pytest

from catseye.app.cell.load import load_cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.errors import ConfigError, UsageError
from catseye.app.results.model import Sign
from catseye.app.results.scara.measured_budget import (
    MeasuredBudget,
    budget_document,
    budget_report,
    measured_budget,
    write_budget,
)
from catseye.app.store.reader import RunReader
from catseye.procedures.scara.radial.radial_error_motion import RadialParams

RUN = "20261127T065153Z_radial-error-motion_3b14fc"


def motion(joint: str, rms_um: float, u_um: float) -> dict[str, Any]:
    dof = 0.5 * (rms_um / u_um) ** 2 if u_um else None
    return {
        "joint": joint,
        "from_deg": -140.0,
        "to_deg": 140.0,
        "rms_um": rms_um,
        "u_rms_um": u_um,
        "budget_dof": dof,
    }


class Stored:
    """A run that has found error motions."""

    def __init__(
        self, *found: dict[str, Any], procedure: str = "radial-error-motion", **params: object
    ) -> None:
        self.path, self.name, self.procedure = Path(RUN), RUN, procedure
        stated = {"u_indicator_um": 0.1, "form_um": 0.2, **params}
        given = RadialParams.model_validate(stated).model_dump(mode="json")
        self.meta = {"procedure": procedure, "cell": "lab-1", "params": given, "simulated": True}
        self.unverified: tuple[str, ...] = ()
        self._found = {f"{row['joint']}/result": row for row in found}

    def result(self, step_id: str) -> Any:
        return self._found.get(step_id)


def changed(folder: Path, *found: dict[str, Any], text: str = TEMPLATE, **stored: Any) -> MeasuredBudget:
    cell = folder / "cell.toml"
    cell.write_text(text, encoding="utf-8")
    return measured_budget(cast("RunReader", Stored(*found, **stored)), load_cell(cell))


def lines(text: str) -> dict[str, dict[str, Any]]:
    return {line["name"]: line for line in tomllib.loads(text)["uncertainty"]["contributor"]}


def test_only_the_measured_lines_change(tmp_path: Path) -> None:
    found = changed(tmp_path, motion("J1", 4.0631, 0.2), motion("J2", 3.4949, 0.1))
    before, after = TEMPLATE.splitlines(), found.text.splitlines()
    assert [line for line in before if line not in after] == ["value_um = 5.0"] * 2
    assert set(after) - set(before) == {
        "value_um = 4.06",
        "value_um = 3.49",
        "degrees_of_freedom = 206.0",
        "degrees_of_freedom = 610.0",
        f'measured_by = "{RUN}"',
    }
    assert len(after) == len(before) + 4
    assert lines(found.text)["radial error motion of J4"] == lines(TEMPLATE)["radial error motion of J4"]


def test_old_and_new_are_said_with_who_measured_them(tmp_path: Path) -> None:
    first = changed(tmp_path, motion("J1", 4.0, 0.2))
    again = changed(tmp_path, motion("J1", 3.0, 0.2), text=first.text)
    report = budget_report(again, written=False)
    assert report.table("budget").rows == (("radial error motion of J1", "4 µm", RUN, "3 µm", "112"),)
    (said,) = report.statements()
    assert said.text.endswith("cell.toml would state: radial error motion of J1 3 µm, was 4 µm.")
    assert budget_report(again, written=True).statements()[0].sign is Sign.GOOD
    document = budget_document(again, written=True)
    assert document.contributors[0].before is not None
    assert document.contributors[0].after.measured_by == RUN


def test_what_is_not_resolved_is_written_as_its_limit(tmp_path: Path) -> None:
    found = changed(tmp_path, motion("J2", 0.1, 0.3))
    line = lines(found.text)["radial error motion of J2"]
    assert line["value_um"] == pytest.approx(0.1 + 2.0 * 0.3)
    assert "degrees_of_freedom" not in line


def test_a_file_without_a_budget_gets_the_whole_default(tmp_path: Path) -> None:
    text = TEMPLATE[: TEMPLATE.index("# The error budget")]
    bare = changed(tmp_path, motion("J1", 4.0, 0.2), text=text)
    assert lines(bare.text).keys() == lines(TEMPLATE).keys()
    (tmp_path / "cell.toml").write_text(bare.text, encoding="utf-8")
    cell = load_cell(tmp_path / "cell.toml").cell
    assert [cell.uncertainty.radial_um(axis) for axis in ("j1", "j2", "j4")] == pytest.approx(
        [4.0, 5.0, 10.0]
    )


def test_a_budget_without_the_line_gets_it(tmp_path: Path) -> None:
    one = '[[uncertainty.contributor]]\nname = "all"\nkind = "length"\nvalue_um = 10.0\n'
    text = TEMPLATE[: TEMPLATE.index("# The error budget")] + one
    found = changed(tmp_path, motion("J1", 4.0, 0.2), text=text)
    assert list(lines(found.text)) == ["all", "radial error motion of J1"]
    assert lines(found.text)["radial error motion of J1"]["correlation"] == "axis-angle"


def test_two_lines_for_one_axis_are_refused(tmp_path: Path) -> None:
    more = (
        '[[uncertainty.contributor]]\nname = "more"\nkind = "radial"\naxis = "j1"\nvalue_um = 1.0\n'
        'correlation = "axis-angle"\n\n[conditions]'
    )
    with pytest.raises(ConfigError, match="several contributors of kind radial stand for j1"):
        changed(tmp_path, motion("J1", 4.0, 0.2), text=TEMPLATE.replace("[conditions]", more))


@pytest.mark.parametrize(
    ("stored", "edit", "text"),
    [
        ({"procedure": "open-loop"}, ("", ""), "no radial error motion"),
        ({}, ('name = "lab-1"', 'name = "lab-2"'), "measured on lab-1, and .* is lab-2"),
        (
            {},
            ('endpoint = "tcp://127.0.0.1:10001"', 'endpoint = "tcp://192.168.0.20:10001"'),
            "emulated bench",
        ),
    ],
)
def test_a_run_that_says_nothing_of_the_cell_is_refused(
    tmp_path: Path, stored: dict[str, Any], edit: tuple[str, str], text: str
) -> None:
    with pytest.raises(UsageError, match=text):
        changed(tmp_path, motion("J1", 4.0, 0.2), text=TEMPLATE.replace(*edit), **stored)


def test_a_small_motion_keeps_its_digits(tmp_path: Path) -> None:
    line = lines(changed(tmp_path, motion("J1", 0.00412, 0.001)).text)["radial error motion of J1"]
    assert (line["value_um"], line["degrees_of_freedom"]) == (0.00412, 8.0)


def test_a_spectrum_goes_with_the_value_it_refers_to(tmp_path: Path) -> None:
    j1 = 'axis = "j1"\nvalue_um = 5.0\n'
    text = TEMPLATE.replace(j1, f"{j1}spectrum = [4.0, 2.0, 1.0, 0.5, 0.25]\n")
    found = changed(tmp_path, motion("J1", 4.0, 0.2), text=text)
    assert found.changes[0].before is not None
    assert found.changes[0].before.spectrum
    assert "spectrum" not in lines(found.text)["radial error motion of J1"]


def test_what_makes_a_value_doubtful_is_said(tmp_path: Path) -> None:
    short = motion("J1", 4.0, 0.2) | {"from_deg": -60.0, "to_deg": 60.0}
    found = changed(tmp_path, short, motion("J2", 3.0, 0.1), form_um=None)
    arc, missing = budget_document(found, written=False).reservations
    assert "J1 was measured over 120° alone" in arc
    assert "the artefact's deviation from roundness" in missing
    assert "degrees of freedom" in missing
    assert not changed(tmp_path, motion("J1", 4.0, 0.2)).reservations


def test_a_name_that_is_taken_is_refused_before_writing(tmp_path: Path) -> None:
    one = (
        '[[uncertainty.contributor]]\nname = "radial error motion of J1"\nkind = "length"\nvalue_um = 10.0\n'
    )
    text = TEMPLATE[: TEMPLATE.index("# The error budget")] + one
    with pytest.raises(
        ConfigError, match=r"cell\.toml cannot take what was measured: .*radial error motion of J1"
    ):
        changed(tmp_path, motion("J1", 4.0, 0.2), text=text)


def test_an_edit_in_the_meantime_is_not_lost(tmp_path: Path) -> None:
    found = changed(tmp_path, motion("J1", 4.0, 0.2))
    edited = TEMPLATE + "# kept\n"
    found.path.write_text(edited, encoding="utf-8")
    with pytest.raises(ConfigError, match="was changed meanwhile"):
        write_budget(found)
    assert found.path.read_text(encoding="utf-8") == edited


def test_what_is_written_is_a_cell_file(tmp_path: Path) -> None:
    found = changed(tmp_path, motion("J1", 4.0, 0.2))
    write_budget(found)
    assert load_cell(found.path).cell.uncertainty.radial_um("j1") == pytest.approx(4.0)

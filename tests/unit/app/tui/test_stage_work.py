"""What a stage of the day asks before it changes the cell file."""

from catseye.app.cell.scara.uncertainty import ContributorEntry
from catseye.app.results.scara.measured_budget_document import ChangedContributor, MeasuredBudgetDocument
from catseye.app.tui.stage_work import changes_text


def line(joint: str, value_um: float) -> ContributorEntry:
    return ContributorEntry(
        name=f"radial error motion of {joint}",
        kind="radial",
        value_um=value_um,
        correlation="axis-angle",
        axis="j1" if joint == "J1" else "j2",
    )


def test_old_and_new_values_stand_side_by_side() -> None:
    changes = [
        ChangedContributor(before=line("J1", 5.0), after=line("J1", 4.06)),
        ChangedContributor(before=None, after=line("J2", 3.49)),
    ]
    preview = MeasuredBudgetDocument(
        cell="/bench/cell.toml",
        run="run",
        written=False,
        contributors=changes,
        reservations=["J1 was measured over 150° alone"],
    )
    assert changes_text(preview.model_dump_json()).splitlines() == [
        "cell.toml",
        "radial error motion of J1: 5 µm → 4.06 µm",
        "radial error motion of J2: none → 3.49 µm",
        "J1 was measured over 150° alone",
    ]

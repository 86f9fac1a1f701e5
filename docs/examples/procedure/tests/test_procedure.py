"""The procedure on an ideal bench, and on one that is not."""

from dataclasses import astuple

import pytest
from norra_readback.procedure import ReadBack

from catseye.app.testing.procedures import IdealContext, run_ideal
from catseye.procedures.kit.errors import PlanError, PlanLimitError, ProcedureError


class Sagging(IdealContext):
    """Reports every axis 0.05° too low."""

    async def joints(self):
        """Return what the controller would report."""
        return tuple(angle - 0.05 for angle in await super().joints())


def test_both_places_are_approached_in_each_cycle():
    seen = run_ideal(ReadBack(), cycles=2, travel_deg=3.0)
    rows = [astuple(record)[1:] for record in seen.records]
    assert rows == [(1, -3.0, -3.0), (1, 3.0, 3.0), (2, -3.0, -3.0), (2, 3.0, 3.0)]
    assert seen.results["result"]["largest_deg"] == 0.0


def test_a_deviation_beyond_the_limit_is_a_warning():
    seen = run_ideal(ReadBack(), context=Sagging)
    assert seen.results["result"]["mean_deg"] == pytest.approx(-0.05)
    (warning,) = [data["text"] for kind, data in seen.notes if kind == "warning"]
    assert warning.startswith("J1 is reported 0.0500° beside its command")
    assert not seen.lives[-1].accepted


def test_nothing_moves_while_somebody_is_in_the_way():
    with pytest.raises(ProcedureError, match="not free"):
        run_ideal(ReadBack(), answers={"free": "no"})


def test_a_resumed_run_goes_on_behind_its_last_step():
    seen = run_ideal(ReadBack(), cycles=2, done={"cycle/0000": {"deviations_deg": [0.5, 0.5]}})
    assert [record.cycle for record in seen.records] == [2, 2]
    assert seen.results["result"]["largest_deg"] == 0.5


@pytest.mark.parametrize(("axis", "error"), [("J9", PlanError), ("J3", PlanError)])
def test_an_axis_that_cannot_be_tested_is_refused(axis, error):
    with pytest.raises(error, match="choose"):
        run_ideal(ReadBack(), axis=axis)


def test_a_place_out_of_range_is_refused(tmp_path):
    cell = tmp_path / "cell.toml"
    text = (
        'format = "catseye-cell/1"\nname = "narrow"\n'
        '[robot]\ndriver = "melfa-r3"\nendpoint = "tcp://127.0.0.1:10001"\n[robot.limits_deg]\nj1 = [-1.0, 170.0]\n'
    )
    cell.write_text(text, encoding="utf-8")
    with pytest.raises(PlanLimitError, match="smaller travel_deg"):
        run_ideal(ReadBack(), cell=cell)

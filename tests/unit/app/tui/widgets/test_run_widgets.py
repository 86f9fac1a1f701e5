"""Bars, bands, pictures and plots of the run screen, against what they should look like."""

import pytest

from catseye.app.protocol.run_events import LiveData, RunEnded
from catseye.app.protocol.scara.layout import ReflectorPlace
from catseye.app.tui.run_state import RunState, Step
from catseye.app.tui.widgets.band_bar import band_bar, band_text, value_text
from catseye.app.tui.widgets.progress_line import bar
from catseye.app.tui.widgets.run_end import _outcome  # noqa: PLC2701  # drawing without a screen
from catseye.app.tui.widgets.run_plots import _scale, _values  # noqa: PLC2701  # drawing without a screen
from catseye.app.tui.widgets.task_picture import task_picture
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.tasks import ClearBeam, MountInterferometer, PlaceReflector, TurnScrew


def live(value: float, low: float | None, high: float | None) -> LiveData:
    return LiveData.of(Live("signal", value, "", low, high))


@pytest.mark.parametrize(
    ("share", "text"),
    [(0.0, "░░░░"), (1.0, "████"), (0.5, "██░░"), (0.28125, "█▏░░"), (2.0, "████"), (-1.0, "░░░░")],
)
def test_a_bar_is_as_full_as_its_share(share: float, text: str) -> None:
    assert bar(share, 4) == text


@pytest.mark.parametrize(
    ("signal", "text"),
    [
        (0.0, "········"),
        (1.0, "████████"),
        (0.5, "████····"),
        (0.5625, "████▌···"),
        (-1.0, "········"),
        (7.0, "████████"),
    ],
)
def test_the_signal_bar_is_filled_by_eighths_of_a_cell(signal: float, text: str) -> None:
    assert bar(signal, 8, "·") == text


@pytest.mark.parametrize(
    ("steps", "text"), [(0, "0 steps"), (1, "1 step, 1 distance"), (2, "2 steps, 2 distances")]
)
def test_the_outcome_counts_steps_and_distances(steps: int, text: str) -> None:
    run = RunState("run", "open-loop", "Measurement", 0.0)
    run.steps.update({str(number): Step(str(number), "", "done") for number in range(steps)})
    run.points_seen = steps
    run.ended = RunEnded(
        run="run", status="stopped", exit_code=130, text="Ada stopped it", path="run", drives_on=False
    )
    assert _outcome(run).plain == f"STOPPED  {text}: Ada stopped it"


@pytest.mark.parametrize(
    ("procedure", "text"),
    [
        ("tracker-calibration", "37 targets"),
        ("ballbar", "37 lengths"),
        ("instrument-check", "37 lengths"),
        ("open-loop", "37 distances"),
    ],
)
def test_the_outcome_names_what_was_measured(procedure: str, text: str) -> None:
    run = RunState("run", procedure, "Measurement", 0.0)
    run.points_seen = 37
    run.ended = RunEnded(run="run", status="complete", exit_code=0, text="", path="run", drives_on=False)
    assert _outcome(run).plain.endswith(f"0 steps, {text}")


def test_the_value_stands_on_its_band() -> None:
    # 21 characters over the band 0…10 and 35 % room on either side: 17 units, 0.85 a character.
    drawn = band_bar(live(5.0, 0.0, 10.0), 21)
    assert drawn.index("●") == 10
    assert [n for n, letter in enumerate(drawn) if letter == "┃"] == [4, 16]
    assert set(drawn[5:10]) == {"░"}
    assert set(drawn[:4]) == {"─"}
    assert band_bar(live(100.0, 0.0, 10.0), 21).endswith("▶")
    assert band_bar(live(-100.0, 0.0, 10.0), 21).startswith("◀")


def test_one_sided_bands_and_none() -> None:
    assert band_bar(live(0.9, 0.6, None), 20).count("┃") == 1
    assert band_bar(live(0.9, None, 1.0), 20).count("┃") == 1
    assert band_bar(live(0.9, None, None), 20) == ""
    assert band_text(0.6, None, "") == "at least 0.6"
    assert band_text(None, 5.0, "µm") == "at most 5 µm"
    assert band_text(-5.0, 5.0, "µm") == "±5 µm"
    assert band_text(0.2, 1.0, "") == "0.2 … 1"
    assert band_text(None, None, "µm") == ""


@pytest.mark.parametrize(("value", "text"), [(0.1234, "0.123"), (-12.345, "-12.35"), (1234.5, "1234.5")])
def test_a_live_value_has_digits_for_a_glance(value: float, text: str) -> None:
    assert value_text(value) == text


def test_a_screw_turns_the_way_that_is_drawn() -> None:
    clockwise = task_picture(TurnScrew(screw="stage", turns=0.25))
    # Clockwise: right above, left below.
    assert "▶" in clockwise[0]
    assert "◀" in clockwise[2]
    assert "0.25 turns clockwise" in clockwise[1]
    assert "90° of the stage screw" in clockwise[2]
    anticlockwise = task_picture(TurnScrew(screw="level", turns=-1.5))
    assert "◀" in anticlockwise[0]
    assert "1.50 turns anticlockwise" in anticlockwise[1]


def test_the_beam_leaves_on_the_other_side_once_turned() -> None:
    before, after = task_picture(MountInterferometer(turned_deg=180.0))
    assert before.startswith("before  ◀━━━━━━(◎)")
    assert after.startswith("after          (◎)━━━━━━▶")
    assert after.endswith("turned by 180° on the flange")


def test_the_nest_that_is_meant_holds_the_reflector() -> None:
    nests = [
        ReflectorPlace(name=name, x_mm=x_mm, y_mm=y_mm, facing_deg=0.0, field_half_angle_deg=80.0)
        for name, x_mm, y_mm in (("P1", 1.0, 2.0), ("P2", 650.0, -400.0))
    ]
    (line,) = task_picture(PlaceReflector(reflector="P2"), nests)
    assert line.startswith("[ ] P1   [◗] P2")
    assert "x 650 mm, y -400 mm" in line
    assert task_picture(PlaceReflector(reflector="P9")) == ["[◗] P9"]
    assert "╳" in task_picture(ClearBeam())[0]
    assert task_picture(None) == []


def test_an_outlier_is_marked_and_does_not_flatten_the_others() -> None:
    seen = [live(value, -5.0, 5.0) for value in (0.0, 2.0, 1000.0, -2.0)]
    low, high = _scale(seen)
    assert (low, high) == (-5.0, 15.0)
    drawn = ["".join(text for text, _ in line) for line in _values(seen, 10, 5)]
    assert sum(line.count("×") for line in drawn) == 1
    # The third of four, newest at the right edge, after eight cells of numbers.
    assert drawn[0].index("×") == 8 + 8
    assert drawn[0].lstrip().startswith("15")
    assert drawn[-1].lstrip().startswith("-5")


def test_a_run_that_is_not_known_has_no_current_step() -> None:
    assert RunState("a", "b", "c", 0.0).current is None

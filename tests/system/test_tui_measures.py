"""A full measurement by keys alone in a terminal of 80 columns and 24 lines, on the emulators."""

from pathlib import Path

import pytest

from tests.patience import HANG_S
from tests.system.by_keys import measure_by_keys, result_of
from tests.system.command import emulated, own_runtime
from tests.system.day_by_keys import Day
from tests.system.screen import on_screen

SPEED = "400"
_FEWER_NODES = {
    "theta1_deg = [-140.0, -120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0]": (
        "theta1_deg = [-80.0, -40.0, 0.0]"
    ),
    "theta2_deg = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0]": "theta2_deg = [30.0, 70.0, 110.0]",
}
_DAY = "\n".join(
    (
        'format = "catseye-campaign/1"',
        'name = "short-day"',
        'reuse = "cell"',
        *(
            f'[[stage]]\nname = "{name}"'
            for name in (
                "reflector-search",
                "open-loop",
                "identify",
                "identify conventional",
                "report",
                "dossier",
            )
        ),
    )
)


@pytest.mark.slow
def test_full_measurement_by_keys_alone(tmp_path: Path) -> None:
    campaign = tmp_path / "short-day.toml"
    campaign.write_text(_DAY, encoding="utf-8")
    with own_runtime(), emulated(tmp_path, "--speed", SPEED, edit=_FEWER_NODES) as bench:
        words = ("tui", "--cell", bench.cell, "--speed", SPEED, "--campaign", campaign)
        with on_screen(*words, cwd=tmp_path) as screen:
            measure_by_keys(screen, HANG_S)
            day = Day(screen)
            day.press("f3")
            for stage in ("identify conventional", "report", "dossier"):
                day.works(stage)
            screen.press("ctrl+q")
            assert screen.ended() == 0
        truth = bench.ask(op="truth")
    # Of all stages after the measurement nothing but Enter was pressed.
    assert day.keys == 1 + 3
    (dossier,) = tmp_path.glob("dossier-*.html")
    assert "Certificate" in dossier.read_text(encoding="utf-8")
    result = result_of(tmp_path)
    assert result["fit"]["n_points"] > 100
    for name in ("link1_mm", "link2_mm"):
        found = result[name]
        # Four standard uncertainties: one case in 16 000 lies outside.
        assert abs(found["value"] - truth["truth"][name]["value"]) < 4.0 * found["u"], name

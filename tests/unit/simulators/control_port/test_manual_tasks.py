"""The control port's operations that act on the mount, the nests and the counters."""

from dataclasses import replace
from typing import Any

import pytest

from catseye.simulators.config import Screws
from catseye.simulators.emulated_bench import EmulatedBench
from catseye.simulators.world.scara.truth import TrueArm
from tests.unit.simulators.benches import QUIET, perfect_arm, without_j4_play
from tests.unit.simulators.control_port.test_session import Panel

CONFIG = replace(
    without_j4_play(QUIET),
    screws=Screws(setting_turns=0.0, play_turns=0.0),
    beam_offset_mm=0.1,
    beam_pitch_mrad=1.0,
    beam_height_mm=0.3,
)


@pytest.fixture
def panel(monkeypatch: pytest.MonkeyPatch) -> Panel:
    """Return a client of a nominal bench whose straight arm looks at P2, 130 mm away."""
    monkeypatch.setattr("catseye.simulators.emulated_bench.draw_truth", _nominal)
    return Panel(EmulatedBench(CONFIG))


def _nominal(_seed: int, config: Any) -> TrueArm:
    return perfect_arm(config)


def state(panel: Panel) -> dict[str, Any]:
    return panel.ask(op="state")


def test_the_state_includes_mount_nests_and_laser(panel: Panel) -> None:
    said = state(panel)
    assert said["mount"] == {
        "turned_deg": 0.0,
        "ahead_mm": 0.0,
        "offset_mm": 0.1,
        "pitch_mrad": pytest.approx(1.0),
        "height_j3_mm": 0.3,
        "turns": {"stage": 0.0, "level": 0.0},
    }
    assert said["in_place"] == ["P1", "P2", "P3"]
    assert said["laser_ready"] is True
    # 0.13 mm up by the tilt, 0.3 mm down at J3 = 0: 0.17 mm below, 0.1 mm beside.
    assert said["beam"]["miss_mm"] == pytest.approx((0.17**2 + 0.1**2) ** 0.5, rel=1e-3)


def test_screws_are_turned_clockwise(panel: Panel) -> None:
    assert panel.ask(op="turn_screw", screw="stage", turns=-0.4) == {"ok": True}
    assert panel.ask(op="turn_screw", screw="level", turns=1) == {"ok": True}
    mount = state(panel)["mount"]
    assert mount["offset_mm"] == pytest.approx(-0.1)
    assert mount["pitch_mrad"] == pytest.approx(3.0)
    # 2 mrad more, 40 mm in front of the pivot.
    assert mount["height_j3_mm"] == pytest.approx(0.3 - 0.08)
    assert mount["turns"] == {"stage": -0.4, "level": 1.0}


def test_the_interferometer_is_mounted_turned(panel: Panel) -> None:
    assert panel.ask(op="mount_interferometer", turned_deg=180) == {"ok": True}
    mount, beam = state(panel)["mount"], state(panel)["beam"]
    # Drawn anew: within four standard deviations of what was asked for, and of what was before.
    assert mount["turned_deg"] == pytest.approx(180.0, abs=4.0)
    assert 0.0 < abs(mount["offset_mm"] - 0.1) < 2.0
    assert 0.0 < abs(mount["pitch_mrad"] - 1.0) < 3.2
    assert beam["direction_deg"] == pytest.approx(mount["turned_deg"])
    assert (beam["returns"], beam["lost"]) == (False, True)


def test_the_reflector_is_carried_and_the_beam_cleared(panel: Panel) -> None:
    assert panel.ask(op="place_reflector", reflector="P3") == {"ok": True, "in_place": ["P3"]}
    assert state(panel)["beam"]["returns"] is False
    assert panel.ask(op="place_reflector", reflector="all")["in_place"] == ["P1", "P2", "P3"]
    panel.fault("block_beam")
    assert state(panel)["beam"]["returns"] is False
    assert panel.ask(op="clear_beam") == {"ok": True}
    assert state(panel)["beam"]["returns"] is True


def test_mishaps_happen_and_are_ended_together(panel: Panel) -> None:
    assert panel.bench.beam.zero()
    panel.fault("overspeed")
    assert panel.bench.beam.read().overspeed
    panel.fault("laser", ready=False)
    assert state(panel)["laser_ready"] is False
    panel.fault("weaken", factor=0.13)
    assert state(panel)["beam"]["returns"] is False
    panel.fault("vibration", amplitude_um=50.0, duration_s=100.0)
    panel.fault("slip", joint=4, deg=5.0)
    panel.bench.advance(1.0)
    shaken_mm = abs(complex(*state(panel)["xy_mm"]) - 550.0)
    assert shaken_mm == pytest.approx(0.050, rel=1e-3)
    panel.fault("clear_faults")
    panel.bench.advance(2.0)
    said = state(panel)
    assert (said["laser_ready"], said["beam"]["returns"]) == (True, True)
    assert abs(complex(*said["xy_mm"]) - 550.0) < 1e-9
    assert panel.bench.beam.zero()


def test_a_slipped_joint_is_where_the_controller_says(panel: Panel) -> None:
    controller = panel.emulation.controller
    controller.switch_servo_on()
    panel.bench.advance(1.0)
    panel.fault("slip", joint=2, deg=-0.3)
    controller.move((10.0, 20.0, 0.0, 30.0))
    panel.bench.advance(5.0)
    assert state(panel)["joints"] == pytest.approx([10.0, 19.7, 0.0, 30.0])
    place = controller.position()
    assert (place.x_mm, place.y_mm) == pytest.approx(state(panel)["xy_mm"], abs=1e-6)


@pytest.mark.parametrize(
    ("request_", "said"),
    [
        ({"op": "turn_screw", "screw": "knob", "turns": 1.0}, "screw"),
        ({"op": "turn_screw", "screw": "stage", "turns": 21.0}, "turns"),
        ({"op": "turn_screw", "screw": "stage", "turns": "1"}, "turns"),
        ({"op": "mount_interferometer", "turned_deg": 400.0}, "turned_deg"),
        ({"op": "mount_interferometer"}, "turned_deg"),
        ({"op": "place_reflector", "reflector": "P9"}, "there are P1, P2, P3"),
        ({"op": "fault", "name": "weaken", "factor": 0.0}, "factor"),
        ({"op": "fault", "name": "vibration", "amplitude_um": -1.0, "duration_s": 1.0}, "amplitude_um"),
        ({"op": "fault", "name": "slip", "joint": 3, "deg": 1.0}, "joint"),
    ],
)
def test_what_cannot_be_done_is_refused_and_changes_nothing(
    panel: Panel, request_: dict[str, object], said: str
) -> None:
    before = state(panel)
    answer = panel.ask(**request_)
    assert answer["ok"] is False
    assert said in str(answer["error"])
    assert state(panel) == before


def test_an_overspeed_without_a_beam_is_refused(panel: Panel) -> None:
    panel.fault("block_beam")
    answer = panel.ask(op="fault", name="overspeed")
    assert (answer["ok"], "aim at a reflector" in str(answer["error"])) == (False, True)

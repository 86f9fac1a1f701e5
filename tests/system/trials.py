"""A short run of every procedure on an emulated bench of its system: what campaigns kill, and take the disk from."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from catseye.app.cell.templates import SIX_AXIS, TEMPLATES
from tests.system.command import Emulated, catseye, emulated, only, own_runtime
from tests.system.interruptions import Story
from tests.system.test_resolution_runs import bench as recording_bench
from tests.system.test_serial_interrupts import calibration_of

NODES: Final = {
    "theta1_deg = [-140.0, -120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0]": (
        "theta1_deg = [-60.0, -30.0]"
    ),
    "theta2_deg = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0]": "theta2_deg = [40.0, 70.0]",
}
_SPEEDS: Final = {"scara": 400.0, "beam": 400.0, "resolution": 20.0, "six-axis": 60.0, "cup": 60.0}
_SLOW: Final = "accept_slow_counter=true"
"""On a busy machine fewer readings arrive: kills are tried here, not the evaluation."""

_RECORDED: Final = ('joints=["A5"]', 'positions=["K3"]', "standstill_s=15.0", "dwell_s=1.5", _SLOW)


@dataclass(frozen=True)
class Trial:
    """A short run of one procedure.

    Attributes:
        system: whose bench it runs on.
        procedure: its name.
        params: that make it short.
        options: of the command beside them.
        fixed: how many steps it has does not depend on what is measured.
    """

    system: str
    procedure: str
    params: tuple[str, ...] = ()
    options: tuple[str, ...] = ()
    fixed: bool = True

    def story(self, bench: Emulated) -> Story:
        """Return a run of it that has not begun."""
        words = [word for param in self.params for word in ("--param", param)]
        speed = f"{_SPEEDS[self.system]:g}"
        return Story(bench, ("run", self.procedure, "--speed", speed, *self.options, *words), "", ())


TRIALS: Final = (
    Trial("scara", "reflector-search", ("poses=4",), fixed=False),
    Trial("scara", "open-loop", ("closures=1", "off_node=0")),
    Trial("scara", "validation-path", ("step_mm=100", "instrument=interferometer"), ("--search", "none")),
    Trial(
        "scara",
        "warmup",
        (
            *("window_min=0.5", "cycle_min=0.05", "checks=1"),
            *("amplitude_share=0.15", "limit_um_per_10min=1000.0"),
        ),
        fixed=False,
    ),
    Trial("scara", "repeatability", ("poses=[[-20.0, 80.0]]", "cycles=4")),
    Trial(
        "scara",
        "radial-error-motion",
        ('joints=["J1"]', "cycles=2", "indicators=2", "step_deg=45", "u_indicator_um=0.1", "form_um=0.4"),
        fixed=False,
    ),
    Trial("beam", "beam-level", fixed=False),
    Trial("beam", "beam-to-j4", fixed=False),
    Trial("resolution", "resolution", (*_RECORDED, "directions=[1]", "steps=6")),
    Trial("resolution", "resolution-iso", (*_RECORDED, "amplitudes_deg=[0.01]")),
    Trial("resolution", "backlash", (*_RECORDED, "step_deg=0.5")),
    Trial(
        "resolution",
        "resolution-cartesian",
        (
            _SLOW,
            "standstill_s=15.0",
            "dwell_s=1.5",
            'directions=["+X"]',
            "steps=5",
            "poses_deg=[[0, -90, 90, 0, 45, 0]]",
        ),
    ),
    Trial("six-axis", "axis-analysis", ('joints=["J4"]', "step_deg=12", "dwell_s=0.5")),
    Trial("six-axis", "ballbar", ("result=result.json", "nests=['nest1']", "step_deg=40", "dwell_s=0.5")),
    Trial("cup", "ballbar-cup", ("result=result.json",)),
    Trial("six-axis", "instrument-check", ("repeats=2", "dwell_s=0.5")),
    Trial(
        "six-axis",
        "tracker-warmup",
        (
            *("exercise_poses=1", "cycles=1", "window_min=2", "checks=1"),
            *("limit_um_per_10min=1000", "dwell_s=0.5"),
        ),
        fixed=False,
    ),
    Trial(
        "six-axis",
        "tracker-calibration",
        ("count=5", "candidates=60", "model=frames", "frames=true", "dwell_s=0.5"),
    ),
    Trial("six-axis", "tracker-validation", ("count=5", "nests_every=2", "dwell_s=0.5")),
)
"""Every procedure; `require_every_procedure` sees to it."""


@contextmanager
def bench_of(system: str, folder: Path) -> Iterator[Emulated]:
    """Emulate the bench of a system, with what its procedures start from."""
    with own_runtime(), _BENCHES[system](folder) as running:
        yield running


@contextmanager
def _scara(folder: Path) -> Iterator[Emulated]:
    with emulated(folder, "--seed", "5", edit={**NODES, **only("P1")}) as running:
        found = catseye("run", "reflector-search", "--cell", running.cell, "--speed", "400", cwd=folder)
        assert found.returncode == 0, found.stderr
        yield running


@contextmanager
def _beam(folder: Path) -> Iterator[Emulated]:
    with emulated(folder, "--unaligned", "--seed", "3") as running:
        yield running


@contextmanager
def _resolution(folder: Path) -> Iterator[Emulated]:
    with recording_bench(folder, 500.0, _SPEEDS["resolution"]) as running:
        cell = running.cell.read_text("utf-8")
        assert "[robot.settings]" not in cell
        # On a busy machine the controller's answers are late.
        running.cell.write_text(f"{cell}\n[robot.settings]\nanswer_timeout_s = 10.0\n", "utf-8")
        yield running


_LEAST: Final = {"centre_mm = [500.0, 0.0, 100.0]": "centre_mm = [500.0, 0.0, 630.0]"}
"""Nobody leads an emulated arm by hand: the cup stands where the arm already holds its nest."""


@contextmanager
def _cup(folder: Path) -> Iterator[Emulated]:
    with _six_axis(folder, _LEAST) as running:
        yield running


@contextmanager
def _six_axis(folder: Path, edit: dict[str, str] | None = None) -> Iterator[Emulated]:
    speed = f"{_SPEEDS['six-axis']:g}"
    text = TEMPLATES[SIX_AXIS].text + "\n[robot.settings]\nanswer_timeout_s = 5.0\ntaken_timeout_s = 20.0\n"
    with emulated(folder, "--seed", "3", "--speed", speed, text=text, edit=edit) as running:
        result = calibration_of(running.ask(op="truth")["truth"])
        (folder / "result.json").write_text(json.dumps(result), encoding="utf-8")
        yield running


_BENCHES: Final = {
    "scara": _scara,
    "beam": _beam,
    "resolution": _resolution,
    "six-axis": _six_axis,
    "cup": _cup,
}

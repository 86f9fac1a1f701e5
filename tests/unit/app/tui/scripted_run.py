"""A run as an engine sends it: steps, values, a question, an end."""

import json
from typing import Any, Final

from catseye.app.protocol.run_events import LiveData
from catseye.app.service.command_process import Done
from catseye.app.tui.run_state import SoFar
from catseye.procedures.kit.live import Live
from tests.unit.app.tui.scripted import ScriptedLink

RUN: Final = "20261121T090000Z_open-loop_abc123"

SNAPSHOT: Final[dict[str, Any]] = {
    "run": RUN,
    "path": f"/bench/catseye-runs/{RUN}",
    "procedure": "open-loop",
    "title": "Automated open-loop tracking measurement",
    "state": "EXECUTE",
    "control": {"client": "tui-1", "who": "Ada"},
}

AXES: Final = [{"name": name, "unit": "mm" if name == "J3" else "deg"} for name in ("J1", "J2", "J3", "J4")]

MOTION: Final[dict[str, Any]] = {
    "id": "stage/1",
    "kind": "confirm",
    "text": "Move the stage 0.14 mm towards −y, 0.29 turns anticlockwise, then confirm.",
    "task": {"do": "turn-screw", "screw": "stage", "turns": -0.29},
    "motion": True,
    "target": [-6.67, 11.67, 50.0, 2.76],
    "override_percent": 20.0,
    "speed_deg_s": [84.0, 144.0, 600.0],
    "axes": AXES,
}

TURNED: Final[dict[str, Any]] = {
    **MOTION,
    "id": "mount/1",
    "text": "Take the interferometer off the flange of J4, mount it turned by half a turn (180°) about the J4 axis, "
    "within 5°, with its cable free, step back, then confirm. The arm stands where its beam then meets P1: the "
    "signal comes back. Then it looks for the beam with J4, also from elsewhere and at other heights.",
    "task": {"do": "mount-interferometer", "turned_deg": 180.0},
    "target": None,
}

REHEARSAL: Final = Done(
    (),
    0,
    json.dumps(
        {
            "procedure": "open-loop",
            "total_s": 5.2,
            "override_percent": 20.0,
            "joint_deg_s": 84.0,
            "tool_mm_s": 240.0,
            "miss_mm": 0.12,
            "max_miss_mm": 0.2,
            "joints": [
                {"name": name, "unit": unit}
                for name, unit in (("J1", "deg"), ("J2", "deg"), ("J3", "mm"), ("J4", "deg"))
            ],
            "steps": [
                {
                    "step": f"P1/{number:04d}",
                    "title": f"P1: θ1 {20 * number - 140}° (+), θ2 0° (+)",
                    "moves": 2,
                    "measurements": 1,
                    "duration_s": 1.3,
                    "first": [20.0 * number - 150.0, 0.0, 50.0, 30.0],
                    "end": [20.0 * number - 140.0, 0.0, 50.0, 30.0],
                    "joint_deg_s": 84.0,
                    "tool_mm_s": 240.0,
                    "beam_mm": 743.0,
                    "miss_mm": 0.12,
                }
                for number in range(8)
            ],
            "warnings": ["reflector P3: 8 commands are blind and left out"],
            "questions": [
                {
                    "id": "place/P1",
                    "kind": "confirm",
                    "text": "Put the reflector into nest P1.",
                    "after_s": 2.6,
                }
            ],
        }
    ),
    "",
)


def publish(link: ScriptedLink, event: str, **fields: Any) -> None:
    """Have the engine send something about the run."""
    link.publish(event, **{**fields, "run": RUN})


def ask(link: ScriptedLink, **fields: Any) -> None:
    """Have the engine ask something."""
    question: dict[str, Any] = {
        "choices": [],
        "unit": "",
        "timeout_s": None,
        "safe_answer": None,
        "task": None,
        "motion": False,
    }
    publish(link, "prompt", **{**question, **fields})


def show_value(
    link: ScriptedLink, name: str, value: float, low: float | None, high: float | None, unit: str
) -> None:
    """Have the engine show a live value."""
    data = LiveData.of(Live(name, value, unit, low, high, "look at it"))
    publish(link, "live", state="EXECUTE", data=data.json_object())


def measure(link: ScriptedLink) -> None:
    """Publish four steps of a measurement, the last one under way."""
    run = link.engine.run
    assert run is not None
    run.take_record(SoFar([], 0, [], ("run", "open-loop", "--dry-run", "--json")))
    for number in range(4):
        step = {"step": f"P1/{number:04d}", "title": f"P1: θ1 {20 * number - 140}° (+), θ2 0° (+)"}
        publish(link, "step-started", **step, attempt=1)
        if number == 3:
            break
        publish(link, "point", step=step["step"], point={"theta1_deg": 1.0})
        publish(link, "step-done", **step, stored=number == 0)
        publish(
            link,
            "happened",
            state="EXECUTE",
            kind="map-known",
            data={"u_theta1_mdeg": 40.0 / (number + 1), "u_theta2_mdeg": 20.0 / (number + 1)},
        )
        show_value(link, "innovation", [1.0, -2.0, 14.0][number], -9.0, 9.0, "µm")
    publish(
        link,
        "progress",
        done=3.9,
        total=10.4,
        text="P1 point 3/8",
        elapsed_bench_s=4.0,
        left_bench_s=6.7,
        elapsed_s=4.0,
        left_s=6.7,
    )
    publish(link, "warning", text="the drift at the reference pose is 31 µm")


def times_s(elapsed_s: float, left_s: float) -> dict[str, float]:
    """Return the times of a word of progress, of a bench at real speed."""
    return {
        "elapsed_bench_s": elapsed_s,
        "left_bench_s": left_s,
        "elapsed_s": elapsed_s,
        "left_s": left_s,
    }


def end(link: ScriptedLink, status: str, text: str = "", **more: object) -> None:
    """End the run.

    Args:
        more: fields of the event.
    """
    publish(
        link,
        "run-ended",
        status=status,
        exit_code=0,
        text=text,
        path=f"/bench/catseye-runs/{RUN}",
        drives_on=False,
        **more,
    )

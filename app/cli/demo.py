"""demo: the whole job of a system on emulated hardware, narrated as it goes and summed up at the end."""

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from catseye.app.cli.failure import write_failure_texts
from catseye.app.cli.options import AsJson, Truth
from catseye.app.cli.output import note

if TYPE_CHECKING:
    from catseye.app.cli.demonstration import Demonstration
    from catseye.app.engine.announcer import Publish

_SPEED = {"scara": 400.0, "resolution": 60.0, "six-axis": 60.0}
_BUSY_SPEED = {"resolution": 30.0}
"""Of a demonstration whose recordings are lost where the computer does not keep up."""
_BUSY_SHARE = 0.5
"""A computer of which so many cores are at work is busy: an engine and an emulator take one core each."""

_SEED = {"scara": 2, "resolution": 1, "six-axis": 0}
_FOLDER = {
    "scara": "catseye-demo",
    "resolution": "catseye-demo-resolution",
    "six-axis": "catseye-demo-six-axis",
}


def demo(
    system: Annotated[
        Literal["scara", "resolution", "six-axis"], typer.Argument(help="what to measure")
    ] = "scara",
    out: Annotated[
        Path | None,
        typer.Option(
            help="folder for everything that the demo writes [catseye-demo, or catseye-demo-SYSTEM]"
        ),
    ] = None,
    speed: Annotated[
        float | None,
        typer.Option(
            min=0.001,
            max=1e6,
            help="bench seconds per real second [scara: 400; resolution: 60, 30 on a busy computer; six-axis: 60]",
        ),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(
            min=0,
            help="random seed of the emulated bench [scara: 2; resolution: 1; six-axis: 0]",
        ),
    ] = None,
    truth: Truth = None,
    as_json: AsJson = False,
) -> None:
    """Measure, evaluate and report on emulated hardware. The devices are emulated behind real sockets.

    Example: catseye demo --out /tmp/demo --seed 7
    """
    from catseye.app.cli.demonstration import DemoInterruptedError, Demonstration

    given = Demonstration(
        out or Path(_FOLDER[system]),
        speed or _speed_of(system),
        _SEED[system] if seed is None else seed,
        truth,
        _narrator,
    )
    note(
        f"emulators at {given.speed:g} times real speed, seed {given.seed}; everything is written to {given.folder}"
    )
    try:
        _demonstrate(system, given, as_json=as_json)
    except DemoInterruptedError as ended:
        write_failure_texts([str(ended)], ended.outcome.exit_code)
        sys.exit(int(ended.outcome.exit_code))


def _demonstrate(system: str, given: "Demonstration", *, as_json: bool) -> None:
    """Do the job of a system; what the others need takes seconds to import and is left alone."""
    match system:
        case "resolution":
            from catseye.app.cli.resolution.demo import demonstrate_resolution as demonstrate
        case "six-axis":
            from catseye.app.cli.serial_arm.demo import demonstrate_six_axis as demonstrate
        case _:
            from catseye.app.cli.scara.demo import demonstrate_scara as demonstrate
    demonstrate(given, as_json=as_json)


def _speed_of(system: str) -> float:
    """Return bench seconds in one real second, where nobody has stated them."""
    busy = os.getloadavg()[0] > _BUSY_SHARE * (os.cpu_count() or 1)
    return _BUSY_SPEED.get(system, _SPEED[system]) if busy else _SPEED[system]


def _narrator(name: str) -> "Publish":
    from catseye.app.cli.narrator import Narrator

    return Narrator(name, as_json=False).publish

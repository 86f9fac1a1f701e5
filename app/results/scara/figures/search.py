"""Signal against J4 where reflectors were looked for, with the return that was found."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from catseye.app.results.figures import Axis, Figure, Level, Mark, Panel, Points, Role
from catseye.calibration.core.types import Floats


@dataclass(frozen=True)
class Scan:
    """Looks for a reflector from one pose.

    Attributes:
        reflector: its name.
        place: of the reflector in the list of reflectors.
        theta1_deg: of the pose.
        theta2_deg: of the pose.
        j4_deg: where J4 stood, in the order of looking, shape (n,).
        signal: there, 0...1, shape (n,).
        found_deg: lower edge, middle and upper edge of the return; None where there was none.
    """

    reflector: str
    place: int
    theta1_deg: float
    theta2_deg: float
    j4_deg: Floats
    signal: Floats
    found_deg: tuple[float, float, float] | None


def scan_figure(scans: Sequence[Scan], signal_min: float) -> Figure:
    """Return a panel for each scan.

    Args:
        signal_min: least signal of a return.
    """
    panels = tuple(_panel(scan, signal_min) for scan in scans)
    caption = (
        "Signal at each look while J4 turned, the newest scan of each reflector, the newest first. The "
        "reflector is taken to stand in the middle of its return."
    )
    return Figure("search-scans", "Signal against J4", caption, (panels,), aspect=0.4)


def _panel(scan: Scan, signal_min: float) -> Panel:
    order = np.argsort(scan.j4_deg, kind="stable")
    looks = Points(
        scan.j4_deg[order],
        scan.signal[order],
        scan.place,
        f"signal of {scan.reflector}",
        joined=True,
        size=3.5,
    )
    marks: list[Mark] = [
        Level(0.0, Role.AXIS),
        Level(signal_min, Role.EXPECTED, dash="dashed", label="least signal of a return"),
        looks,
    ]
    found = "no return"
    if scan.found_deg is not None:
        lower, middle, upper = scan.found_deg
        found = f"J4 = {middle:.3f}°"
        edges = (
            Level(edge, Role.AXIS, vertical=True, dash="dotted", label="edges of the return")
            for edge in (lower, upper)
        )
        marks += [*edges, Level(middle, Role.CHOSEN, vertical=True, width=1.4, label="middle of the return")]
    title = f"{scan.reflector} from θ1 {scan.theta1_deg:g}°, θ2 {scan.theta2_deg:g}°: {found}"
    return Panel(title, Axis("J4 / °"), Axis("signal", low=-0.05, high=1.05), tuple(marks))

"""select-poses: which poses of a serial arm to measure."""

from contextlib import closing
from pathlib import Path
from typing import Annotated, Literal

import typer

from catseye.app.cli.arm_option import described
from catseye.app.cli.options import AsJson
from catseye.app.cli.output import note, write_json
from catseye.app.cli.progress import ProgressBar
from catseye.app.cli.report_output import note_statements, write_tables
from catseye.app.errors import UsageError
from catseye.app.files.atomic import require_output, write_atomically


def select_poses(
    arm: Annotated[
        str, typer.Option(metavar="NAME|FILE", help="a shipped arm, or the path of a description")
    ],
    tool: Annotated[Path, typer.Option(metavar="FILE", help="tool TOML with its targets")],
    count: Annotated[int, typer.Option(min=1, help="poses to choose")],
    output: Annotated[Path, typer.Option("-o", "--output", help="poses CSV to write")],
    candidates: Annotated[int, typer.Option(min=2, max=200_000, help="random poses to choose from")] = 5000,
    index: Annotated[
        Literal["O1", "O2", "O3", "O4", "O5"], typer.Option(help="observability index to raise")
    ] = "O1",
    model: Annotated[
        Literal["frames", "geometric", "geometric+compliance"],
        typer.Option(help="whose parameters the poses are to show"),
    ] = "geometric+compliance",
    station: Annotated[
        str | None,
        typer.Option(metavar="X,Y,Z", help="place of the instrument in the arm's base frame, mm"),
    ] = None,
    cone_deg: Annotated[
        float, typer.Option(min=1.0, max=180.0, help="half angle of a target that has a normal")
    ] = 30.0,
    limit: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=LOW:HIGH", help="narrower range of a joint; may be repeated"),
    ] = None,
    approach: Annotated[
        float, typer.Option(min=0.0, max=90.0, help="deg (mm) below which each joint comes from")
    ] = 5.0,
    bodies: Annotated[
        bool, typer.Option("--bodies/--no-bodies", help="the bodies of the arm's description count")
    ] = True,
    starts: Annotated[int, typer.Option(min=1, max=1000, help="random choices to begin with")] = 3,
    seed: Annotated[int, typer.Option(min=0, help="of candidates and starts")] = 1,
    page: Annotated[
        Path | None,
        typer.Option("--report", metavar="FILE", help="HTML page with the index against the poses"),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Choose the poses that identify a serial arm best.

    Example: catseye select-poses --arm irb120 --tool plate.toml --count 38 --station 1800,0,400 -o poses.csv
    """
    from catseye.app.cell.tool import read_tool
    from catseye.app.render.page import require_html, write_page
    from catseye.app.results.serial_arm.pose_selection import Asked, select_poses, selection_report

    require_output(output, tool)
    require_output(page, tool, output)
    if page is not None:
        require_html(page)
    asked = Asked(
        count,
        candidates,
        index,
        model,
        starts,
        seed,
        None if station is None else _place(station),
        cone_deg,
        dict(map(_limit, limit or ())),
        approach,
        bodies,
    )
    with closing(_Bars()) as bars:
        found = select_poses(described(arm), read_tool(tool), asked, bars.update)
    write_atomically(output, found.csv())
    report = selection_report(found, arm)
    if as_json:
        write_json({"output": str(output), **found.document()})
    else:
        write_tables(report)
    note_statements(report)
    if page is not None:
        write_page(report, page)
        note(f"{page} written")
    note(f"{output} written")


class _Bars:
    """A bar for each part of the work, one after the other."""

    def __init__(self) -> None:
        self._title = ""
        self._bar = ProgressBar("")

    def update(self, title: str, done: float, total: float, text: str) -> None:
        if title != self._title:
            self._bar.close()
            self._title, self._bar = title, ProgressBar(title)
        self._bar.update(done, total, text)

    def close(self) -> None:
        self._bar.close()


def _place(text: str) -> tuple[float, float, float]:
    try:
        x_mm, y_mm, z_mm = map(float, text.split(","))
    except ValueError as error:
        raise UsageError(f"--station {text}: give three numbers in mm, such as 1800,0,400") from error
    return x_mm, y_mm, z_mm


def _limit(text: str) -> tuple[str, tuple[float, float]]:
    name, _, ends = text.partition("=")
    try:
        low, high = map(float, ends.split(":"))
    except ValueError as error:
        raise UsageError(f"--limit {text}: give NAME=LOW:HIGH, such as A2=0:110") from error
    if not low < high:
        raise UsageError(f"--limit {text}: {low:g} is not below {high:g}")
    return name, (low, high)

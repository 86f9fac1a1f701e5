"""select-poses: which poses of a serial arm to measure."""

from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from catseye.app.cli.arm_option import described
from catseye.app.cli.options import AsJson
from catseye.app.cli.output import note, write_document
from catseye.app.cli.progress import ProgressBar
from catseye.app.cli.report_output import note_statements, write_tables
from catseye.app.errors import UsageError
from catseye.app.files.atomic import require_output, write_atomically

if TYPE_CHECKING:
    from catseye.app.results.serial_arm.pose_selection import ChosenPoses
    from catseye.app.results.serial_arm.pose_setup import Asked, PoseSetup


_Arm = Annotated[
    str | None, typer.Option(metavar="NAME|FILE", help="name of a shipped arm, or path of an arm description")
]
_Tool = Annotated[Path | None, typer.Option(metavar="FILE", help="tool TOML with its targets")]
_CellFile = Annotated[
    Path | None,
    typer.Option(
        "--cell",
        help="cell file with arm, tool, limits, instrument, bodies and boxes, instead of the "
        "options for them",
    ),
]
_Station = Annotated[
    str | None, typer.Option(metavar="X,Y,Z", help="position of the instrument in the arm's base frame, mm")
]
_Limits = Annotated[
    list[str] | None,
    typer.Option("--limit", metavar="NAME=LOW:HIGH", help="narrower range of a joint; may be repeated"),
]
_Cone = Annotated[
    float | None,
    typer.Option(
        min=1.0,
        max=180.0,
        help="largest angle between a target's normal and the line of sight [that of --cell, otherwise 30]",
    ),
]
_Face = Annotated[
    float | None,
    typer.Option(
        min=1.0,
        max=90.0,
        help="the same for a plate of marks, with --measured poses [that of --cell, otherwise 15]",
    ),
]
_Measured = Annotated[
    Literal["points", "poses"] | None,
    typer.Option(help="points (tracker) or poses (optical CMM) [those of --cell, otherwise points]"),
]
_Targets = Annotated[
    list[str] | None,
    typer.Option("--target", metavar="NAME", help="target of the tool to measure; may be repeated [all]"),
]
_PerPose = Annotated[int, typer.Option(min=1, max=20, help="targets to measure at a pose, if visible")]
_Approach = Annotated[
    float, typer.Option(min=0.0, max=90.0, help="every joint approaches from this much below, deg (mm)")
]
_Bodies = Annotated[
    bool,
    typer.Option(
        "--bodies/--no-bodies", help="whether the bodies of the arm can collide and block the line of sight"
    ),
]
_Index = Annotated[
    Literal["O1", "O2", "O3", "O4", "O5"], typer.Option(help="observability index to maximise")
]
_Model = Annotated[
    Literal["frames", "geometric", "geometric+compliance", "maps"],
    typer.Option(help="model whose parameters the poses have to identify"),
]
_Page = Annotated[
    Path | None,
    typer.Option("--report", metavar="FILE", help="HTML page to write: index against number of poses"),
]


def select_poses(
    count: Annotated[int, typer.Option(min=1, help="number of poses to choose")],
    output: Annotated[Path, typer.Option("-o", "--output", help="poses CSV to write")],
    arm: _Arm = None,
    tool: _Tool = None,
    cell: _CellFile = None,
    candidates: Annotated[
        int, typer.Option(min=2, max=200_000, help="number of random poses to choose from")
    ] = 5000,
    index: _Index = "O1",
    model: _Model = "geometric+compliance",
    station: _Station = None,
    cone_deg: _Cone = None,
    face_deg: _Face = None,
    measured: _Measured = None,
    target: _Targets = None,
    targets_per_pose: _PerPose = 1,
    limit: _Limits = None,
    approach: _Approach = 5.0,
    bodies: _Bodies = True,
    starts: Annotated[int, typer.Option(min=1, max=1000, help="number of random starts")] = 3,
    seed: Annotated[int, typer.Option(min=0, help="seed of candidates and starts")] = 1,
    page: _Page = None,
    as_json: AsJson = False,
) -> None:
    """Choose the best poses to calibrate a serial arm.

    Example: catseye select-poses --arm irb120 --tool plate.toml --count 38 --station 1800,0,400 -o poses.csv
    """
    from catseye.app.render.page import require_html
    from catseye.app.results.serial_arm.pose_selection import select_poses as choose
    from catseye.app.results.serial_arm.pose_setup import Asked

    sources = [file for file in (tool, cell) if file is not None]
    require_output(output, *sources)
    require_output(page, *sources, output)
    if page is not None:
        require_html(page)
    asked = Asked(
        count=count,
        candidates=candidates,
        index=index,
        model=model,
        starts=starts,
        seed=seed,
        station_mm=None if station is None else _place(station),
        cone_deg=cone_deg,
        face_deg=face_deg,
        targets=tuple(target or ()),
        measured=measured,
        targets_per_pose=targets_per_pose,
        limits=dict(map(_limit, limit or ())),
        approach=approach,
        with_bodies=bodies,
    )
    setup, name = _setup(arm, tool, cell, asked)
    with closing(_Bars()) as bars:
        found = choose(setup, asked, bars.update)
    _write(found, name, output, page, as_json=as_json)


def _setup(arm: str | None, tool: Path | None, cell: Path | None, asked: "Asked") -> "tuple[PoseSetup, str]":
    """Return what poses are chosen for, and what it is called."""
    from catseye.app.cell.load import load_cell
    from catseye.app.cell.tool import read_tool
    from catseye.app.results.serial_arm.pose_setup import setup_of, setup_of_cell

    if cell is not None:
        beside = (arm, tool, asked.station_mm, asked.cone_deg, asked.face_deg)
        if any(one is not None for one in beside) or not asked.with_bodies:
            raise UsageError(
                "--cell has arm, tool, instrument and bodies: leave out --arm, --tool, --station, --cone-deg, "
                "--face-deg, --no-bodies"
            )
        known = load_cell(cell).cell
        return setup_of_cell(known, asked), known.name
    if arm is None or tool is None:
        raise UsageError("state --arm and --tool, or a cell file with --cell")
    return setup_of(described(arm), read_tool(tool), asked), arm


def _write(found: "ChosenPoses", name: str, output: Path, page: Path | None, *, as_json: bool) -> None:
    from catseye.app.render.page import write_page
    from catseye.app.results.serial_arm.pose_selection import selection_report

    write_atomically(output, found.csv())
    report = selection_report(found, name)
    if page is not None:
        write_page(report, page)
        note(f"{page} written")
    if as_json:
        document = found.document().model_copy(update={"output": str(output)})
        write_document("pose-selection", document.model_dump(mode="json"))
    else:
        write_tables(report)
    note_statements(report)
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

"""Another cell file for this program and its engine."""

from pathlib import Path

from catseye.app.tui.dialogs.questions import ConfirmDialog
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.program import Program


def use_cell(app: Program, path: Path) -> None:
    """Have everything go on with a cell file; the idle engine is started anew with it.

    Args:
        path: the cell file; it has passed every check.
    """
    link = app.session.link
    app.session.cell = link.cell = path.absolute()
    engine = link.engine
    if not engine.connected:
        return
    if engine.running:
        app.notify(
            "the run under way keeps its cell; the engine uses the new one when it is restarted",
            title=path.name,
            severity="warning",
            markup=False,
        )
    elif is_of(engine, path) and len(engine.clients) <= 1:
        _start_anew(app)
    else:
        _ask(app, path)


def look_at_cell(app: Program) -> None:
    """Ask what is to be done when the engine that was found has another cell file than this program."""
    engine, cell = app.session.link.engine, app.session.cell
    if cell is None:
        app.session.cell = app.session.link.cell = _cell_of(engine)
    elif not is_of(engine, cell) and not engine.running:
        _ask(app, cell)


def _ask(app: Program, path: Path) -> None:
    engine = app.session.link.engine
    others = len(engine.clients) - 1
    used = f"{others} other program(s) use it. " if others > 0 else ""
    text = (
        f"The running engine has {_cell_of(engine)}.\n{used}End it and start one with {path}? Nothing moves."
    )

    def answered(agreed: bool | None) -> None:
        if agreed:
            _start_anew(app)
        else:
            _keep(app)

    app.push_screen(
        ConfirmDialog("An engine of another cell", text, "start again", "keep its cell"), answered
    )


def _start_anew(app: Program) -> None:
    from catseye.app.protocol.requests import Plain

    ended: list[bool] = []
    # The link looks for an engine again by itself, finds none, and starts one.
    order = app.order(
        Plain(op="shutdown"),
        "The engine was not restarted with the cell",
        control=True,
        then=lambda: ended.append(True),
    )
    # What is shown of the bench is of the engine's cell: no run may begin on another one than that.
    order.add_done_callback(lambda _order: None if ended else _keep(app))


def _keep(app: Program) -> None:
    app.session.cell = app.session.link.cell = _cell_of(app.session.link.engine) or app.session.cell


def _cell_of(engine: EngineState) -> Path | None:
    snapshot = engine.snapshot
    return None if snapshot is None or not snapshot.cell else Path(snapshot.cell)


def is_of(engine: EngineState, path: Path) -> bool:
    """Return whether an engine has a cell file."""
    cell = _cell_of(engine)
    return cell is not None and cell.absolute() == path.absolute()

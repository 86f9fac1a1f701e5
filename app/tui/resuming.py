"""Going on with a run that was interrupted, from every screen that names one."""

from typing import Final

from catseye.app.tui.dialogs.start_dialog import Permission, StartDialog
from catseye.app.tui.program import Program
from catseye.app.tui.rehearsing import Verdict, rehearsed
from catseye.app.tui.start_text import start_rows

_WHAT: Final = (
    "The run continues with the next step. Before anything moves, it compares the devices and asks you what may "
    "have been moved."
)


def ask_to_resume(program: Program, run: str, about: str, cell: str, *, simulated: bool | None) -> None:
    """Show what would go on; F8 there goes on.

    Args:
        run: its name.
        about: what is known of it, one line.
        cell: its name, which a real arm asks for.
    """
    session = program.session

    def text(verdict: Verdict) -> str:
        rows = start_rows(session.link.engine, verdict, session.now_s())
        return "\n".join([run, about, *rows, "", _WHAT])

    dialog = StartDialog("Continue an interrupted run", text(Verdict("under way")), cell, simulated=simulated)

    async def rehearse() -> None:
        words = ("resume", run, "--runs", session.root, "--dry-run", "--json")
        dialog.show_text(text(await rehearsed(session.work, *words)))

    rehearsing = program.keep(rehearse())

    def resume(permission: Permission | None) -> None:
        rehearsing.cancel()
        if permission is not None:
            fields = {"op": "resume", "run": run, "arm": permission.arm}
            program.order_of(fields, f"{run} does not go on", then=lambda: program.action_go("run"))

    program.push_screen(dialog, resume)

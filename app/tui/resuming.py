"""Going on with a run that was interrupted, from every screen that names one."""

from typing import Final

from catseye.app.tui.dialogs.start_dialog import Permission, StartDialog
from catseye.app.tui.program import Program

_WHAT: Final = (
    "It goes on with the next step that is not done. Before anything moves the devices are compared, and it is asked "
    "what may have been moved."
)


def ask_to_resume(program: Program, run: str, about: str, cell: str, *, simulated: bool | None) -> None:
    """Show what would go on; F8 there goes on.

    Args:
        run: its name.
        about: what is known of it, one line.
        cell: its name, which a real arm asks for.
    """

    def resume(permission: Permission | None) -> None:
        if permission is not None:
            from catseye.app.protocol.requests import Resume

            request = Resume(run=run, arm=permission.arm)
            program.order(
                request, f"{run} does not go on", control=True, then=lambda: program.action_go("run")
            )

    text = f"{run}\n{about}\n\n{_WHAT}"
    program.push_screen(StartDialog("Go on with an interrupted run", text, cell, simulated=simulated), resume)

"""What is said of a fault of this program itself."""

import traceback


def fault_text(error: BaseException) -> str:
    """Return what happened and where, to be copied into a report."""
    where = "".join(traceback.format_exception(error)).strip()
    return (
        "Engine and run go on; F12 stops the arm. What is shown may be incomplete: quit with Ctrl-Q (leave the run "
        f"running) and start catseye tui again.\n\n{where}"
    )

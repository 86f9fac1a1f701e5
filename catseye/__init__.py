"""Calibration of robot arms with a laser interferometer: drivers, procedures, emulators, identification, programs.

`load(path)` opens a run, a result or a cell file (docs/api.md).
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from catseye.app.results.loading import load as load

__all__ = ["load"]


def __getattr__(name: str) -> Any:
    # Imported when it is first asked for: it takes numpy and scipy, without which the command line starts.
    if name == "load":
        from catseye.app.results.loading import load

        return load
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

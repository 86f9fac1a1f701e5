"""Series of a run as the files that `catseye resolution --recording --moves` takes."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from catseye.app.results.resolution.recorded_series import RecordedSeries, series_of_run
from catseye.app.store.reader import RunReader


def series_files(reader: RunReader) -> Iterator[tuple[str, str]]:
    """Yield name and text of the files of each whole series: recording, moves, and joint torque where there is any.

    Raises:
        StorageError: readings are missing or are not what was written.
    """
    for series in series_of_run(reader):
        yield (
            f"{series.name}-recording.csv",
            _csv(("t_s", "displacement_mm"), (series.time_s, series.displacement_mm), ("%.6f", "%.9f")),
        )
        yield f"{series.name}-moves.csv", _moves(series)
        if (torque_nm := series.torque_nm()) is not None:
            columns = series.torque_time_s(), torque_nm
            yield f"{series.name}-torque.csv", _csv(("t_s", "torque_nm"), columns, ("%.6f", "%.6g"))


def _moves(series: RecordedSeries) -> str:
    sequence = np.array([move["sequence"] for move in series.moves])
    return _csv(
        ("t_s", f"command_{series.unit}", "sequence"),
        (series.move_time_s(), series.command(), sequence),
        ("%.6f", "%.9f", "%d"),
    )


def _csv(names: Sequence[str], columns: Sequence[NDArray[np.generic]], forms: Sequence[str]) -> str:
    form = ",".join(forms)
    rows = zip(*(column.tolist() for column in columns), strict=True)
    return "\n".join([",".join(names), *(form % row for row in rows)]) + "\n"

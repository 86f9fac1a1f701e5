"""Runs of procedures that measure targets, as the tables that calibrate and validate take."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

from catseye.app.cli.arm_option import described
from catseye.app.cli.output import warn
from catseye.app.errors import UsageError

if TYPE_CHECKING:
    from catseye.app.cell.arm import ArmDescription
    from catseye.app.cell.tool import ToolDescription
    from catseye.app.results.model import Origin
    from catseye.app.results.serial_arm.result import SerialArmResult
    from catseye.app.store.reader import RunReader


@dataclass(frozen=True)
class MeasuredRuns:
    """Runs with their poses as tables.

    Attributes:
        readers: of the runs.
        tables: CSV of each, which are gone afterwards.
    """

    readers: list["RunReader"] = field(default_factory=list)
    tables: list[Path] = field(default_factory=list)

    def subject(
        self, arm: str | None, tool: "ToolDescription | None"
    ) -> tuple[str, "ArmDescription", "ToolDescription | None"]:
        """Return the arm with its name and its tool: those that are given, else those of the first run.

        Args:
            arm: --arm.
            tool: of --tool.

        Raises:
            UsageError: there is neither a run nor an arm, or runs differ in arm or tool and neither is given.
        """
        from catseye.app.cell.arm import arm_description
        from catseye.app.results.runs.run_source import cell_of_run
        from catseye.app.results.serial_arm.one_subject import require_one_subject

        if not self.readers:
            if arm is None:
                raise UsageError("a table does not say which arm it is of: state --arm, irb120 for example")
            return arm, described(arm), tool
        require_one_subject(self.readers, arm_stated=arm is not None, tool_stated=tool is not None)
        robot = cell_of_run(self.readers[0]).robot
        carried = robot.carried if tool is None else tool
        if arm is not None:
            return arm, described(arm), carried
        description = arm_description(robot.arm)
        return robot.arm if isinstance(robot.arm, str) else description.name, description, carried

    def require_subject_of(self, result: Path) -> None:
        """Refuse runs of another arm or tool than a result's.

        Raises:
            UsageError: they differ.
        """
        from catseye.app.results.serial_arm.one_subject import require_subject_of
        from catseye.app.results.serial_arm.result import read_serial_arm

        known = read_serial_arm(result)
        for reader in self.readers:
            require_subject_of(known, reader)

    def stated(self, result: "SerialArmResult", poses: Sequence[Path]) -> "SerialArmResult":
        """Return a result that says which runs it comes from, its base as uncertain as the world frame of one run."""
        from catseye.app.results.runs.run_source import are_simulated
        from catseye.app.results.serial_arm.frame_noise import with_frame_noise
        from catseye.app.results.serial_arm.run_poses import world_covariance

        if not self.readers or result.provenance is None:
            return result
        origin = {
            "runs": [*(reader.name for reader in self.readers), *map(str, poses)],
            "simulated": are_simulated(self.readers),
            "unverified": [text for reader in self.readers for text in reader.unverified] or None,
        }
        frame = None if len(self.readers) > 1 or poses else world_covariance(self.readers[0])
        known = result if frame is None else with_frame_noise(result, frame)
        return known.model_copy(update={"provenance": result.provenance.model_copy(update=origin)})

    def origin_with(self, result: "SerialArmResult") -> "Origin":
        """Return the origin of what is made of the runs and a result now."""
        from catseye.app.results.origin import joined
        from catseye.app.results.runs.run_source import origin_of_run

        return joined([result.origin, *map(origin_of_run, self.readers)])


@contextmanager
def measured_runs(
    names: Sequence[str], folder: Path | None, *, unverified: bool = False, beside: bool = False
) -> Iterator[MeasuredRuns]:
    """Give runs by their names, with their poses as tables.

    Args:
        beside: other tables are read with them.

    Raises:
        UsageError: there is no such run, or it has measured no targets.
        StorageError: it is damaged or was changed.
    """
    from catseye.app.results.serial_arm.run_poses import as_tables, pose_notes
    from catseye.app.store.catalog import resolve_run
    from catseye.app.store.reader import RunReader, accept
    from catseye.app.store.runs_folder import runs_folder

    readers = [
        RunReader(resolve_run(runs_folder(folder), name), accept(unverified=unverified)) for name in names
    ]
    for text in chain.from_iterable(map(pose_notes, readers)):
        warn(text)
    with as_tables(readers, beside=beside) as tables:
        yield MeasuredRuns(readers, tables)

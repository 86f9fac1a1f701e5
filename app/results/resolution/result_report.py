"""The report of results of motion resolution: certificate, tables and figures of the resolution paper."""

from collections.abc import Sequence
from pathlib import Path

from catseye.app.results.figures import Figure
from catseye.app.results.model import (
    Block,
    Bullets,
    Origin,
    Report,
    Section,
    section,
)
from catseye.app.results.numbers import CONVENTION_OF_U
from catseye.app.results.origin import origin_now
from catseye.app.results.provenance import Provenance
from catseye.app.results.resolution.cartesian_comparison import compared_steps, comparison_blocks
from catseye.app.results.resolution.certificate import certificate
from catseye.app.results.resolution.figures.cartesian_steps import cartesian_step_figure
from catseye.app.results.resolution.figures.joint_models import joint_model_figure
from catseye.app.results.resolution.figures.least_steps import least_step_figure
from catseye.app.results.resolution.figures.predicted_errors import predicted_error_figure
from catseye.app.results.resolution.figures.staircase import staircase_figure
from catseye.app.results.resolution.figures.step_errors import step_error_figure
from catseye.app.results.resolution.joint_tables import TablesFile
from catseye.app.results.resolution.naming import SHIPPED, joints_of, title
from catseye.app.results.resolution.predicted import PredictedResolution
from catseye.app.results.resolution.prediction_report import prediction_said
from catseye.app.results.resolution.recorded_runs import result_of_runs
from catseye.app.results.resolution.report_files import ReportFiles, read_report_files
from catseye.app.results.resolution.result import Actuation, AnyTest, ResolutionResult
from catseye.app.results.resolution.tables_of_tests import (
    actuation_table,
    cartesian_table,
    least_step_table,
    method_table,
    reversal_table,
)
from catseye.app.results.resolution.verdict import verdict
from catseye.app.results.runs.records import Sources
from catseye.app.results.runs.trace import sources_of, trace_section
from catseye.app.store.reader import RunReader
from catseye.calibration.resolution.decaying import THRESHOLD_PERCENT

_CONVENTIONS = (
    "Step error: measured minus commanded step, in percent of the commanded one.",
    "Least increment step (LIS): the smallest commanded step for which, and for every larger step, the moving mean "
    "of the step error over 11 steps stays within the threshold.",
    "A least step is that of the mean error: the value that the rule would give for the mean of many series. "
    "Beside it is the value that the rule gives for this one series; another series would give a value some steps "
    "away.",
    "Low and high of a least step are its 95 % interval.",
    CONVENTION_OF_U,
    "Reversal error: mean position reached backwards minus that reached forwards, at the positions between the ends. "
    "Lost motion is positive, so it is the negative of ISO 230-2's reversal error (forwards minus backwards). "
    "It is play only where the motor torque changes its sign between the directions.",
    f"{SHIPPED} comes with the program: recorded on the emulated bench, not on this arm.",
    "Steps that are commanded below what the instrument resolves stand in the result and are not judged.",
)


def resolution_files_report(sources: Sequence[Path]) -> Report:
    """Return the report of results, with the predictions and look-up tables among the files.

    Raises:
        UsageError: a file is missing or wrong, or they are of several arms.
    """
    files = read_report_files(sources)
    alone = len(sources) == 1
    heading = f"Result {sources[0].name}" if alone else f"Motion resolution of {files.results[0].arm}"
    return resolution_report(heading, files, sources_of(sources))


def resolution_run_report(reader: RunReader) -> Report:
    """Return the report of a run that has recorded tests, evaluated with the threshold of ASME B5.64.

    Raises:
        CalibrationError: a recording does not fit its moves.
    """
    result = result_of_runs([reader], THRESHOLD_PERCENT)
    return resolution_report(
        f"{reader.meta.get('procedure')} on {result.arm}", ReportFiles((result,)), sources_of()
    )


def resolution_report(heading: str, files: ReportFiles, sources: Sources) -> Report:
    """Return the report of one arm.

    Args:
        heading: of the page.
        files: results, whose tests are shown together, with what was predicted.
        sources: what the report is made with and from.
    """
    results = files.results
    tests = [test for result in results for test in result.tests]
    refused = [text for result in results for text in result.refused]
    actuation = list({one.joint: one for result in results for one in result.actuation}.values())
    origin = _origin(files)
    joints = joints_of(tests)
    sections = (
        certificate(results, tests, files.predicted, sources),
        section("verdict", "Verdict", verdict(tests, refused), brief=True),
        section("actuation", "Actuation", [actuation_table(actuation)]),
        _least_steps(tests, actuation),
        section("errors", "Step errors", [step_error_figure(joint, tests) for joint in joints]),
        section("reversal", "Reversal error", [reversal_table(tests)], brief=True),
        _cartesian(tests, files.predicted),
        _models(joints, tests, files.tables),
        section("recordings", "Recordings", _staircases(tests)),
        section("flags", "What was noticed", _flags(tests)),
        section("conventions", "Conventions", [Bullets("", _CONVENTIONS)]),
        trace_section(origin.software, sources, [], [one.software for one in _provenances(results)]),
    )
    return Report(heading, origin, sections)


def _cartesian(tests: Sequence[AnyTest], predictions: Sequence[PredictedResolution]) -> Section:
    """Return what was measured of the tool, beside what was predicted where there is a prediction."""
    predicted = [least for one in predictions for least in one.least_steps]
    compared = compared_steps(predicted, tests)
    if not predicted:
        blocks: list[Block | None] = [cartesian_table(tests), cartesian_step_figure(compared)]
        return section("cartesian", "Cartesian directions", blocks, brief=True)
    poses = list(dict.fromkeys(one.test.pose or "" for one in compared))
    return section(
        "cartesian",
        "Cartesian directions",
        [
            *(statement for one in predictions for statement in prediction_said(one)),
            *(comparison_blocks(compared) if compared else ()),
            cartesian_step_figure(compared),
            *(predicted_error_figure(pose, compared) for pose in poses),
        ],
        brief=True,
    )


def _models(joints: Sequence[str], tests: Sequence[AnyTest], file: TablesFile | None) -> Section:
    figures = [] if file is None else [joint_model_figure(joint, file.tables, tests) for joint in joints]
    return section("models", "Joint models", figures)


def _least_steps(tests: Sequence[AnyTest], actuation: Sequence[Actuation]) -> Section:
    figures = [least_step_figure(joint, tests) for joint in joints_of(tests)]
    return section(
        "least-steps",
        "Least increment steps",
        [least_step_table(tests, actuation), method_table(tests), *figures],
        brief=True,
    )


def _staircases(tests: Sequence[AnyTest]) -> list[Figure | None]:
    """Return one recording of each kind and joint: that of the middle position."""
    groups: dict[tuple[str, str], list[AnyTest]] = {}
    for test in tests:
        if test.staircase is not None:
            groups.setdefault((test.joint, test.test), []).append(test)
    return [staircase_figure(members[len(members) // 2]) for members in groups.values()]


def _flags(tests: Sequence[AnyTest]) -> list[Block | None]:
    return [Bullets(f"{title(test)} ({test.test})", tuple(test.flags)) for test in tests if test.flags]


def _provenances(results: Sequence[ResolutionResult]) -> list[Provenance]:
    return [result.provenance for result in results if result.provenance is not None]


def _origin(files: ReportFiles) -> Origin:
    known = _provenances(files.results)
    unverified = list(dict.fromkeys(text for one in known for text in one.unverified or ()))
    predicted = any(one.simulated for one in files.predicted)
    modelled = files.tables is not None and files.tables.simulated
    simulated = predicted or modelled or any(one.simulated for one in known)
    return origin_now(simulated=simulated, unverified=unverified)

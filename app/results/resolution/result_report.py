"""The report of results of motion resolution: certificate, tables and figures of the resolution paper."""

from collections.abc import Sequence
from pathlib import Path

from catseye.app.errors import UsageError
from catseye.app.results.figures import Figure
from catseye.app.results.model import (
    Block,
    Bullets,
    Column,
    Entries,
    Origin,
    Paragraph,
    Report,
    Section,
    Sign,
    Statement,
    Table,
    section,
)
from catseye.app.results.numbers import counted, listed
from catseye.app.results.origin import origin_now
from catseye.app.results.provenance import Provenance
from catseye.app.results.resolution.figures.least_steps import least_step_figure
from catseye.app.results.resolution.figures.staircase import staircase_figure
from catseye.app.results.resolution.figures.step_errors import step_error_figure
from catseye.app.results.resolution.naming import joints_of, least_step_text, place, title, with_unit
from catseye.app.results.resolution.recorded_runs import result_of_runs
from catseye.app.results.resolution.result import Actuation, AnyTest, ResolutionResult, read_resolution
from catseye.app.results.resolution.tables_of_tests import (
    actuation_table,
    cartesian_table,
    least_step_table,
    method_table,
    reversal_table,
)
from catseye.app.results.runs.records import Sources
from catseye.app.results.runs.trace import sources_of, trace_section
from catseye.app.store.reader import RunReader
from catseye.calibration.resolution.decaying import THRESHOLD_PERCENT

_CONVENTIONS = (
    "Step error: measured minus commanded step, in percent of the commanded one.",
    "Least increment step (LIS): the smallest commanded step from which on the moving mean of the step error, over "
    "11 steps, keeps within the threshold, for it and every larger step.",
    "Low and high of a least step are its 95 % interval; other uncertainties are standard uncertainties (k = 1).",
    "Reversal error: mean position reached forwards against that reached backwards at the positions between the "
    "ends; lost motion is positive. It is play only where the motor torque changes its sign between the directions.",
    "Steps that are commanded below what the instrument resolves are shown nowhere and judged nowhere.",
)


def resolution_files_report(sources: Sequence[Path]) -> Report:
    """Return the report of result files.

    Raises:
        UsageError: a file is missing or no result, or they are of several arms.
    """
    results = [read_resolution(source) for source in sources]
    arms = list(dict.fromkeys(result.arm for result in results))
    if len(arms) > 1:
        raise UsageError(f"the results are of several arms: {', '.join(arms)}; make a report of each")
    heading = f"Motion resolution of {arms[0]}" if len(sources) > 1 else f"Result {sources[0].name}"
    return resolution_report(heading, results, sources_of(sources))


def resolution_run_report(reader: RunReader) -> Report:
    """Return the report of a run that has recorded tests, evaluated with the threshold of ASME B5.64.

    Raises:
        CalibrationError: a recording does not fit its moves.
    """
    result = result_of_runs([reader], THRESHOLD_PERCENT)
    return resolution_report(f"{reader.meta.get('procedure')} on {result.arm}", [result], sources_of())


def resolution_report(heading: str, results: Sequence[ResolutionResult], sources: Sources) -> Report:
    """Return the report of results of one arm.

    Args:
        heading: of the page.
        results: at least one; their tests are shown together.
        sources: what the report is made with and from.
    """
    tests = [test for result in results for test in result.tests]
    actuation = list({one.joint: one for result in results for one in result.actuation}.values())
    origin = _origin(results)
    sections = (
        _certificate(results, tests),
        section("verdict", "Verdict", verdict(tests), brief=True),
        section("actuation", "Actuation", [actuation_table(actuation)]),
        _least_steps(tests, actuation),
        section("errors", "Step errors", [step_error_figure(joint, tests) for joint in joints_of(tests)]),
        section("reversal", "Reversal error", [reversal_table(tests)], brief=True),
        section("cartesian", "Cartesian directions", [cartesian_table(tests)], brief=True),
        section("recordings", "Recordings", _staircases(tests)),
        section("flags", "What was noticed", _flags(tests)),
        section("conventions", "Conventions", [Bullets("", _CONVENTIONS)]),
        trace_section(origin.software, sources, [], [one.software for one in _provenances(results)]),
    )
    return Report(heading, origin, sections)


def verdict(tests: Sequence[AnyTest]) -> list[Block]:
    """Return what the tests come to, a statement each; several positions of a joint in one."""
    statements: list[Block] = []
    for test in tests:
        statements += _said_of(test)
    shipped = [test for test in tests if test.shipped]
    if shipped:
        text = (
            f"{counted(len(shipped), 'shipped recording')} of the emulated bench among the tests, which say nothing "
            f"about this arm: {listed((title(test) for test in shipped), 6)}"
        )
        statements.append(Statement(Sign.ATTENTION, text))
    return statements


def _said_of(test: AnyTest) -> list[Statement]:
    if test.test == "backlash":
        return _reversal_said(test)
    name = f"{title(test)}, ISO 230" if test.test == "iso" else title(test)
    if test.lis is None:
        why = f": {test.flags[-1]}" if test.flags else ""
        return [Statement(Sign.ATTENTION, f"{name}: no least step can be stated{why}")]
    return [Statement(Sign.NEUTRAL, f"{name}: least step {least_step_text(test)}")]


def _reversal_said(test: AnyTest) -> list[Statement]:
    if test.reversal is None:
        return [Statement(Sign.ATTENTION, f"{place(test)}: no reversal error can be stated")]
    said = f"{place(test)}: reversal error {with_unit(test.reversal.value, test.unit)}"
    if test.reversal.valid:
        return [Statement(Sign.NEUTRAL, f"{said}; the torque changes its sign: it is lost motion")]
    why = "no torque was recorded" if test.reversal.valid is None else "the torque keeps its sign"
    return [Statement(Sign.ATTENTION, f"{said}; {why}: it says nothing certain about play")]


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


def _certificate(results: Sequence[ResolutionResult], tests: Sequence[AnyTest]) -> Section:
    """Return one page for the file: what was measured, how, and the worst of each joint."""
    runs = [name for result in results if result.provenance for name in result.provenance.runs]
    thresholds = sorted({test.threshold_percent for test in tests})
    about = (
        ("arm", ", ".join(dict.fromkeys(result.arm for result in results))),
        ("tests", counted(len(tests), "test")),
        ("threshold", ", ".join(f"{percent:g} %" for percent in thresholds)),
        ("measured in", listed(runs, 8) or "recordings of other programs"),
        ("evaluated", ", ".join(dict.fromkeys(_evaluated(result) for result in results))),
        ("signed", "………………………………………"),
    )
    rows = tuple(_worst(joint, [test for test in tests if test.joint == joint]) for joint in joints_of(tests))
    columns = (
        Column("joint", "joint, axis"),
        Column("tests", "tests"),
        Column("lis", "largest least step (95 %)"),
        Column("iso", "largest by ISO 230"),
        Column("reversal", "largest valid reversal error"),
    )
    table = Table("certificate", "Largest values over all positions and directions", columns, rows)
    note = Paragraph(
        "This page states the results in short; how they were found stands on the following ones."
    )
    return section("certificate", "Certificate", [Entries(about), table, note])


def _worst(joint: str, tests: Sequence[AnyTest]) -> tuple[str | int | None, ...]:
    valid = [test for test in tests if test.reversal is not None and test.reversal.valid]
    worst = max(valid, key=lambda test: test.reversal.value if test.reversal else 0.0, default=None)
    return (
        joint,
        str(len(tests)),
        _largest([test for test in tests if test.test in {"decaying", "cartesian"}]),
        _largest([test for test in tests if test.test == "iso"]),
        None if worst is None or worst.reversal is None else with_unit(worst.reversal.value, worst.unit),
    )


def _largest(tests: Sequence[AnyTest]) -> str | None:
    stated = [test for test in tests if test.lis is not None]
    largest = max(stated, key=lambda test: test.lis.value if test.lis else 0.0, default=None)
    return None if largest is None else least_step_text(largest)


def _evaluated(result: ResolutionResult) -> str:
    source = result.provenance
    return "by another program" if source is None else f"{source.created} by {source.software}"


def _provenances(results: Sequence[ResolutionResult]) -> list[Provenance]:
    return [result.provenance for result in results if result.provenance is not None]


def _origin(results: Sequence[ResolutionResult]) -> Origin:
    known = _provenances(results)
    unverified = list(dict.fromkeys(text for one in known for text in one.unverified or ()))
    return origin_now(simulated=any(one.simulated for one in known), unverified=unverified)

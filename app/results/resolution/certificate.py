"""The certificate: one page that states the results in short, with what they can be traced to."""

from collections.abc import Sequence

from catseye.app.results.model import Column, Entries, Paragraph, Section, Table, section
from catseye.app.results.numbers import BLANK, counted, listed, utc_text
from catseye.app.results.resolution.cartesian_comparison import direction_word
from catseye.app.results.resolution.naming import joints_of, least_step_text, shipped_mark, with_unit
from catseye.app.results.resolution.predicted import PredictedResolution
from catseye.app.results.resolution.result import AnyTest, ResolutionResult
from catseye.app.results.runs.records import Sources

_NOTE = (
    "This page states the results in short; how they were found, what limits them and what was noticed is on the "
    "following ones. It holds for the arm at the positions, loads and temperature of the tests."
)


def certificate(
    results: Sequence[ResolutionResult],
    tests: Sequence[AnyTest],
    predicted: Sequence[PredictedResolution],
    sources: Sources,
) -> Section:
    """Return one page for the file: what was measured, with what, when, and the largest values of each joint."""
    about = (
        ("arm", ", ".join(dict.fromkeys(result.arm for result in results))),
        ("serial number", BLANK),
        ("tests", _tests_text(tests)),
        ("threshold", ", ".join(f"{one:g} %" for one in sorted({test.threshold_percent for test in tests}))),
        *_measured(results),
        ("evaluated", ", ".join(dict.fromkeys(_evaluated(result) for result in results))),
        *((("prediction", ", ".join(map(_prediction_text, predicted))),) if predicted else ()),
        *((("files", _digests(sources)),) if sources.digests else ()),
        ("place, date, signature", BLANK),
    )
    rows = tuple(_largest_of(name, members) for name, members in _groups(tests))
    columns = (
        Column("joint", "joint, direction"),
        Column("tests", "tests"),
        Column("lis", "largest least step (95 %)"),
        Column("iso", "largest by ISO 230"),
        Column("reversal", "largest valid reversal error"),
    )
    table = Table("certificate", "Largest values over all positions, directions and poses", columns, rows)
    return section("certificate", "Certificate", [Entries(about), table, Paragraph(_NOTE)])


def _tests_text(tests: Sequence[AnyTest]) -> str:
    shipped = sum(test.shipped for test in tests)
    not_own = f", {shipped} of them shipped with the program and not of this arm" if shipped else ""
    return f"{len(tests)}{not_own}"


def _measured(results: Sequence[ResolutionResult]) -> list[tuple[str, str]]:
    """Return runs, time, operator and instruments; of recordings of other programs only their names are known."""
    names = [name for result in results if result.provenance for name in result.provenance.runs]
    runs = [run for result in results for run in result.measured]
    known = [("measured in", listed(dict.fromkeys(names), 8) or "recordings of another program")]
    if runs:
        started = sorted(run.started_utc[:10] for run in runs)
        known.append(("measured on", " … ".join(dict.fromkeys((started[0], started[-1])))))
    for label, texts in (
        ("operator", [run.operator for run in runs]),
        ("instruments", [text for run in runs for text in run.devices]),
        ("optics", [text for run in runs for text in run.optics]),
    ):
        known.append((label, "; ".join(dict.fromkeys(text for text in texts if text)) or BLANK))
    return known


def _evaluated(result: ResolutionResult) -> str:
    source = result.provenance
    return "by another program" if source is None else f"{utc_text(source.created)} by {source.software}"


def _prediction_text(predicted: PredictedResolution) -> str:
    return f"{utc_text(predicted.created)} from {predicted.tables}, {counted(predicted.draws, 'draw')}"


def _digests(sources: Sources) -> str:
    return ", ".join(f"{name} (SHA-256 {digest[:16]}…)" for name, digest in sources.digests.items())


def _groups(tests: Sequence[AnyTest]) -> list[tuple[str, list[AnyTest]]]:
    """Return tests by joint, those of the tool by direction."""
    of_joints = [test for test in tests if test.test != "cartesian"]
    groups = [(joint, [test for test in of_joints if test.joint == joint]) for joint in joints_of(of_joints)]
    of_tool: dict[str, list[AnyTest]] = {}
    for test in tests:
        if test.test == "cartesian":
            of_tool.setdefault(direction_word(test).replace("-", "−"), []).append(test)
    return [*groups, *of_tool.items()]


def _largest_of(name: str, tests: Sequence[AnyTest]) -> tuple[str | int | None, ...]:
    valid = [test for test in tests if test.reversal is not None and test.reversal.valid]
    worst = max(valid, key=lambda test: test.reversal.value if test.reversal else 0.0, default=None)
    return (
        name,
        str(len(tests)),
        _largest([test for test in tests if test.test in {"decaying", "cartesian"}]),
        _largest([test for test in tests if test.test == "iso"]),
        _reversal_text(worst),
    )


def _reversal_text(test: AnyTest | None) -> str | None:
    if test is None or test.reversal is None:
        return None
    return f"{with_unit(test.reversal.value, test.unit)}{shipped_mark([test])}"


def _largest(tests: Sequence[AnyTest]) -> str | None:
    """Return the largest least step, and how many tests have none."""
    stated = [test for test in tests if test.lis is not None]
    largest = max(stated, key=lambda test: test.lis.value if test.lis else 0.0, default=None)
    without = f"; {len(tests) - len(stated)} without one" if len(stated) < len(tests) else ""
    return None if largest is None else f"{least_step_text(largest)}{without}"

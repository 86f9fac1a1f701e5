"""What a result file is worth: its sections, its figure and its table for a certificate, whatever arm it is of."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from catseye.app.results.model import Origin, Section, Sign, Statement, Table
from catseye.app.results.numbers import EXPANDED, counted
from catseye.app.results.origin import origin_now
from catseye.app.results.resolution.certificate import certificate as certificate_of_steps
from catseye.app.results.resolution.naming import SHIPPED
from catseye.app.results.resolution.report_files import is_of_resolution
from catseye.app.results.resolution.result import ResolutionResult, read_resolution
from catseye.app.results.resolution.result_report import resolution_files_report
from catseye.app.results.result_file import format_of
from catseye.app.results.runs.records import Sources
from catseye.app.results.scara.fit_text import distances_text
from catseye.app.results.scara.identification_report import identification_report
from catseye.app.results.scara.result import Result, read_result
from catseye.app.results.scara.values import Kind, largest_map_u_mdeg, parameter_table
from catseye.app.results.serial_arm.calibration_report import calibration_report
from catseye.app.results.serial_arm.certificate import certificate as certificate_of_arm
from catseye.app.results.serial_arm.result import SerialArmResult, is_of_serial_arm, read_serial_arm

_RESULTS: Final = frozenset(
    kind.model_fields["format"].default for kind in (Result, ResolutionResult, SerialArmResult)
)

_ARM: Final[tuple[Kind, ...]] = ("arm",)


@dataclass(frozen=True)
class Worth:
    """What is said of a stage.

    Attributes:
        sign: how it is meant.
        figure: in a few words, with expanded uncertainties (k = 2) where there are any.
        short: the figure alone, for a list of stages; empty where the figure is short.
        sections: brief ones of its report.
        tables: for the certificate.
        origins: of what it was made from.
    """

    sign: Sign = Sign.NEUTRAL
    figure: str = ""
    sections: tuple[Section, ...] = ()
    tables: tuple[Table, ...] = ()
    origins: tuple[Origin, ...] = ()
    short: str = ""


def is_result(path: Path) -> bool:
    """Return whether a file of a stage holds identified or evaluated values; predictions, tables and pages do not."""
    return path.suffix.lower() == ".json" and format_of(path) in _RESULTS


def worth_of_result(path: Path) -> Worth:
    """Return what a result file is worth.

    Raises:
        UsageError: it cannot be read.
    """
    if is_of_serial_arm(path):
        return _of_serial_arm(path.name, read_serial_arm(path))
    if is_of_resolution(path):
        return _of_resolution(path, read_resolution(path))
    return _of_scara(path.name, read_result(path))


def _of_scara(name: str, result: Result) -> Worth:
    u_mdeg = largest_map_u_mdeg(result)
    maps = "" if u_mdeg is None else f"maps U ≤ {EXPANDED * u_mdeg:.1f} mdeg; "
    fit = f"{distances_text(result.fit.n_points, result.fit.n_returns)}, residuals {result.fit.rms_um:.1f} µm rms"
    # The certificate states the model that is to be used; the conventional one stands with its stage.
    tables = () if u_mdeg is None else (_named(parameter_table(result, _ARM), name),)
    report = identification_report(result)
    # Nobody expects of the conventional model, which others are compared with, that it explains the distances.
    sign = Sign.NEUTRAL if u_mdeg is None else worst_sign(report.sections)
    return Worth(sign, f"{maps}{fit}", report.sections, tables, (result.provenance.origin,))


def _of_serial_arm(name: str, result: SerialArmResult) -> Worth:
    report = calibration_report(name, result)
    left = result.cross_validation
    figure = f"poses left out missed by {left.mean_mm:.3f} mm on average, {left.max_mm:.3f} mm at most"
    sections = tuple(one for one in report.sections if one.brief)
    tables = _tables(certificate_of_arm(result), name)
    return Worth(worst_sign(sections), figure, sections, tables, (result.origin,))


def _of_resolution(path: Path, result: ResolutionResult) -> Worth:
    stated = sum(test.lis is not None for test in result.tests)
    shipped = sum(test.shipped for test in result.tests)
    not_own = (
        f"; {shipped} of them ({SHIPPED}) shipped with the program and not of this arm" if shipped else ""
    )
    figure = f"{counted(len(result.tests), 'test')}, {stated} with a least step{not_own}"
    sections = tuple(one for one in resolution_files_report([path]).sections if one.brief)
    tables = _tables(certificate_of_steps([result], result.tests, (), Sources()), path.name)
    origin = origin_now() if result.provenance is None else result.provenance.origin
    return Worth(worst_sign(sections), figure, sections, tables, (origin,))


def worst_sign(sections: Iterable[Section]) -> Sign:
    """Return the sign of the statement that is least in order; good where nothing speaks against anything."""
    signs = {block.sign for one in sections for block in one.blocks if isinstance(block, Statement)}
    return next((sign for sign in (Sign.BAD, Sign.ATTENTION) if sign in signs), Sign.GOOD)


def _tables(certificate: Section, name: str) -> tuple[Table, ...]:
    return tuple(_named(block, name) for block in certificate.blocks if isinstance(block, Table))


def _named(table: Table, name: str) -> Table:
    return Table(table.key, f"{table.caption} ({name})", table.columns, table.rows)

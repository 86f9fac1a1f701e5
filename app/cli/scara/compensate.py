"""compensate, of a SCARA: commands that bring it where it shall go, or tables that make its controller do so."""

from pathlib import Path
from typing import TYPE_CHECKING, Literal, TypeAlias

from catseye.app.cli.output import note, warn, write_document
from catseye.app.cli.report_output import note_statements, write_tables
from catseye.app.cli.scara.options import HandName
from catseye.app.errors import UsageError
from catseye.app.files.atomic import require_output, write_atomically

if TYPE_CHECKING:
    from catseye.app.cli.scara.compensation import Correction
    from catseye.app.results.scara.compensated_path import Origin
    from catseye.calibration.scara.identification import IdentifiedArm


Form: TypeAlias = Literal["csv", "json", "melfa", "kw-ssfk"]


def compensate(
    result: Path,
    output: Path,
    path: Path | None = None,
    format_: Form = "csv",
    hand: HandName = "right",
    start_direction: str = "1,1",
    cell: Path | None = None,
    j4: float = 0.0,
    as_json: bool = False,
) -> None:
    """Turn the model round.

    Raises:
        UsageError: what the form needs is missing.
    """
    from catseye.app.cli.scara.compensation import correction_of, origin_of, write_correction
    from catseye.app.results.scara.identified_arm import arm_of, arm_remarks
    from catseye.app.results.scara.result import read_result

    require_output(output, result, path, cell)
    identified = read_result(result)
    arm, origin = arm_of(identified), origin_of(result, identified)
    for text in arm_remarks(identified):
        warn(f"{text}.")
    if format_ == "kw-ssfk":
        _write_tables(arm, origin, output, path, as_json)
        return
    if path is None:
        raise UsageError(f"--format {format_} needs --path FILE, a path file with the path to correct")
    correction = correction_of(
        arm, origin, path, format_, hand=hand, start=start_direction, cell=cell, j4_deg=j4
    )
    write_correction(correction, origin, format_, output)
    _report(correction, output, format_, as_json=as_json)
    note(f"{output} written")


def _report(correction: "Correction", output: Path, form: str, *, as_json: bool) -> None:
    from catseye.app.results.scara.compensation_report import compensation_document, compensation_report

    report = compensation_report(correction.path, correction.warnings)
    note_statements(report)
    if as_json:
        document = compensation_document(correction.path, output, form, correction.warnings)
        write_document("path-compensation", document.json_object())
    else:
        write_tables(report)


def _write_tables(
    arm: "IdentifiedArm", origin: "Origin", output: Path, path: Path | None, as_json: bool
) -> None:
    from catseye.app.cli.documents import CompensationTables
    from catseye.app.results.scara.ssfk_table import maps_of, ssfk_table

    if path is not None:
        raise UsageError("a table (--format kw-ssfk) holds for every path: omit --path")
    # The controller reads one list for each axis.
    files = [output.with_name(f"{output.stem}-j{joint}{output.suffix}") for joint in (1, 2)]
    texts = [
        ssfk_table(joint, joint_map, origin) for joint, joint_map in zip((1, 2), maps_of(arm), strict=True)
    ]
    for file, text in zip(files, texts, strict=True):
        write_atomically(file, text)
    note(
        f"links are not part of a table: give the controller's kinematics {origin.links_mm[0]:.4f} and "
        f"{origin.links_mm[1]:.4f} mm; read the comments at the head of the files before they are used"
    )
    if as_json:
        tables = CompensationTables(output=[str(file) for file in files], links_mm=origin.links_mm)
        write_document("table-compensation", tables.json_object())
    note(f"{files[0]} and {files[1]} written")

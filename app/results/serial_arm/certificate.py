"""The certificate of a calibrated serial arm: the result on one page, with what it can be traced to."""

from catseye.app.results.model import Column, Entries, Paragraph, Quantity, Section, Table, section
from catseye.app.results.numbers import BLANK, THREE_DIGITS, counted, fixed, listed, utc_text
from catseye.app.results.serial_arm.result import SerialArmResult

_NOTE = (
    "The errors are 3-D norms at poses that were left out of the identification. They hold for this arm with this "
    "tool, at the loads and the temperature of the measurement; compensated commands are to be tried slowly first. "
    "How the parameters were found and what limits them is on the following pages."
)


def certificate(result: SerialArmResult) -> Section:
    """Return one page for the file."""
    tool, source = result.tool, result.provenance
    about = (
        ("arm", result.arm if result.description is None else f"{result.description.name} ({result.arm})"),
        ("serial number", BLANK),
        ("tool", "places of its targets identified" if tool is None else f"{tool.name}, {tool.mass_kg:g} kg"),
        ("model", f"{result.model}, {counted(result.fit.n_parameters, 'parameter')}"),
        ("measured in", BLANK if source is None else listed(source.runs, 8)),
        ("rows", f"{result.fit.n_rows}; {counted(len(result.rejected), 'pose')} left out"),
        ("uncertainties", _uncertainties(result)),
        ("evaluated", BLANK if source is None else f"{utc_text(source.created)} by {source.software}"),
        ("instrument, its certificate", BLANK),
        ("operator", BLANK),
        ("place, date, signature", BLANK),
    )
    return section("certificate", "Certificate", [Entries(about), _errors(result), Paragraph(_NOTE)])


def _uncertainties(result: SerialArmResult) -> str:
    if result.monte_carlo is not None:
        return f"U, expanded (k = 2), Monte Carlo with {result.monte_carlo.draws} draws"
    return "U, expanded (k = 2), by the law of propagation"


def _errors(result: SerialArmResult) -> Table:
    columns = (
        Column("state", "state"),
        Column("mean", "mean error", "mm", fixed(3)),
        Column("max", "largest", "mm", fixed(3)),
        Column("ratio", "of before"),
    )
    held, frames = result.cross_validation, result.frames
    ratio = None if frames is None or not frames.mean_mm else held.mean_mm / frames.mean_mm
    after = ("calibrated, poses left out", held.mean_mm, held.max_mm, Quantity(ratio, THREE_DIGITS))
    if frames is None:
        return Table("certificate", "Position errors", columns, (after,))
    before = ("links as drawn, frames fitted", frames.mean_mm, frames.max_mm, None)
    return Table("certificate", "Position errors", columns, (before, after))

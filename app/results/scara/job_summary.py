"""What a whole job on an emulated bench ends with: the truth beside what was identified, and what models leave."""

from catseye.app.results.model import Column, Quantity, Report, Sign, Statement, Table, section
from catseye.app.results.numbers import OF_UNIT, fixed
from catseye.app.results.origin import origin_now
from catseye.app.results.scara.fit_text import distances_text
from catseye.app.results.scara.result import Fit
from catseye.app.results.scara.truth import TruthComparison
from catseye.app.results.scara.validation import PathValidation
from catseye.app.results.scara.validation_report import comparison_table
from catseye.app.results.scara.validation_text import LEFT_OUT, path_statement


def job_summary(truth: TruthComparison, fit: Fit, validation: PathValidation) -> Report:
    """Return the summary of a job.

    Args:
        validation: models on an independently measured path.
    """
    quality = (
        f"{distances_text(fit.n_points, fit.n_returns)}, residuals {fit.rms_um:.1f} µm rms; errors over their u: "
        f"{truth.rms_normalised:.2f} rms (1 is honest)."
    )
    left_out = f"{int((~validation.compared).sum())} rows of the path are left out {LEFT_OUT}."
    statements = (
        Statement(Sign.NEUTRAL, quality),
        path_statement(validation),
        Statement(Sign.NEUTRAL, left_out),
    )
    return Report(
        "Summary",
        origin_now(simulated=True),
        (
            section("parameters", "Identified arm", [_table(truth)], brief=True),
            section("validation", "Validation path", [comparison_table(validation)], brief=True),
            section("verdict", "Verdict", statements, brief=True),
        ),
    )


def _table(truth: TruthComparison) -> Table:
    form = fixed(4)
    columns = zip(
        truth.names, truth.units, truth.truth, truth.identified, truth.u, truth.normalised, strict=True
    )
    return Table(
        "identified",
        "Identified arm",
        (
            Column("name", "parameter"),
            Column("unit", "unit"),
            Column("truth", "truth", format=form),
            Column("identified", "identified", format=form),
            Column("u", "U (k=2)", format=form, standard=True),
            Column("normalised", "error/u", format=fixed(2, signed=True)),
        ),
        tuple(
            (
                name,
                unit,
                *(Quantity(float(value), OF_UNIT[unit]) for value in (true, found, u)),
                float(error),
            )
            for name, unit, true, found, u, error in columns
        ),
    )

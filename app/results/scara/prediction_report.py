"""What a prediction says."""

from catseye.app.results.model import Report, Sign, Statement, section
from catseye.app.results.numbers import fixed
from catseye.app.results.origin import origin_now
from catseye.app.results.scara.prediction import PredictedPath
from catseye.app.results.summary import Line, summary_table

_UM = fixed(1)


def prediction_report(path: PredictedPath) -> Report:
    """Return warnings and a summary of a prediction."""
    figures = path.figures()
    lines = (
        Line("rows predicted", "", f"{figures['predicted']} of {figures['rows']}"),
        Line("error of the arm, 2-D rms", "µm", figures["rms_um"], _UM),
        Line("error of the arm, largest", "µm", figures["max_um"], _UM),
        Line("its standard uncertainty, 2-D median", "µm", figures["median_u_um"], _UM),
        Line("its standard uncertainty, 2-D largest", "µm", figures["max_u_um"], _UM),
    )
    warnings = [Statement(Sign.ATTENTION, f"{text}.") for text in path.warnings]
    table = summary_table("predicted minus command", lines)
    return Report(
        "Prediction",
        origin_now(),
        (
            section("verdict", "Verdict", warnings, brief=True),
            section("summary", "Summary", [table], brief=True),
        ),
    )

"""Tables of a validation."""

from catseye.app.analysis.file_validation import FileValidation
from catseye.app.analysis.joint_maps import ARCSEC_PER_MDEG
from catseye.app.analysis.validation import ModelOnPath
from catseye.app.cli.output import table
from catseye.app.report.numbers import probability
from catseye.app.report.path_view import model_title
from catseye.app.report.validation_facts import model_facts

_LINES = (
    ("rotation of the frame", "mdeg"),
    ("  standard uncertainty", "mdeg"),
    ("shift in x", "mm"),
    ("  standard uncertainty in x", "mm"),
    ("shift in y", "mm"),
    ("  standard uncertainty in y", "mm"),
    ("rms in x", "µm"),
    ("rms in y", "µm"),
    ("rms 2-D", "µm"),
    ("largest 2-D", "µm"),
    ("  in line", ""),
    ("ratio to the first model", ""),
    ("u of prediction, 2-D median", "µm"),
    ("rms 2-D that is expected", "µm"),
    ("share of variance explained", "%"),
    ("normalised errors within ±2", "%"),
    ("probability", ""),
)


def tables(found: FileValidation) -> str:
    """Return the models on the path, and the standards' quantities of a map."""
    return "\n\n".join([_models_table(found), *([_standards_table(found)] if found.maps else [])])


def _models_table(found: FileValidation) -> str:
    models = found.validation.models
    head = ["measured minus predicted", "unit", *(model_title(model) for model in models)]
    columns = [_cells(model, found) for model in models]
    return table(head, [[name, unit, *(column[name] for column in columns)] for name, unit in _LINES])


def _cells(model: ModelOnPath, found: FileValidation) -> dict[str, str]:
    facts = model_facts(model, found)
    alignment = facts["alignment"]
    within = facts["within_2u"]
    return {
        "rotation of the frame": f"{alignment['rotation_mdeg']['value']:.2f}",
        "  standard uncertainty": f"{alignment['rotation_mdeg']['u']:.2f}",
        "shift in x": f"{alignment['shift_x_mm']['value']:.4f}",
        "  standard uncertainty in x": f"{alignment['shift_x_mm']['u']:.4f}",
        "shift in y": f"{alignment['shift_y_mm']['value']:.4f}",
        "  standard uncertainty in y": f"{alignment['shift_y_mm']['u']:.4f}",
        "rms in x": f"{facts['rms_x_um']:.1f}",
        "rms in y": f"{facts['rms_y_um']:.1f}",
        "rms 2-D": f"{facts['rms_um']:.1f}",
        "largest 2-D": f"{facts['max_um']:.1f}",
        "  in line": f"{facts['max_line']}",
        "ratio to the first model": f"{facts['ratio']:.3f}",
        "u of prediction, 2-D median": f"{facts['median_u_um']:.1f}",
        "rms 2-D that is expected": f"{facts['expected_um']:.1f}",
        "share of variance explained": f"{100.0 * model.agreement.share:.0f}",
        "normalised errors within ±2": "–" if within is None else f"{100.0 * within:.0f}",
        "probability": probability(facts["probability"]).removeprefix("p ").removeprefix("= "),
    }


def _standards_table(found: FileValidation) -> str:
    rows = [
        [
            f"J{one.joint}",
            quantity.symbol,
            quantity.name,
            f"{quantity.value:.2f}",
            f"{quantity.u:.2f}",
            f"{ARCSEC_PER_MDEG * quantity.value:.2f}",
            f"{ARCSEC_PER_MDEG * quantity.u:.2f}",
        ]
        for one in found.maps
        for quantity in one.quantities()
    ]
    return table(["joint", "", "ISO 230-2, from the map", "mdeg", "u (k=1)", "arcsec", "u (k=1)"], rows)

"""What a corrected path gained: measured against the wish, beside what models predict with and without correction."""

from dataclasses import dataclass

import numpy as np

from catseye.app.results.figures import Axis, Figure, Level, Panel, Points, Role
from catseye.app.results.model import Block, Column, Paragraph, Sign, Statement, Table
from catseye.app.results.numbers import fixed
from catseye.app.results.scara.path_view import model_title, path_axis, there
from catseye.app.results.scara.validation import PathValidation
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.comparison import rigid_fit

_UM = fixed(1)


@dataclass(frozen=True)
class Gain:
    """Errors of one kind along the compared rows.

    Attributes:
        what: whose positions they are.
        error_mm: positions minus wished ones, frames aligned, shape (n, 2); NaN where they are not compared.
    """

    what: str
    error_mm: Floats

    @property
    def rms_um(self) -> float:
        """Rms of their lengths, µm."""
        return 1e3 * float(np.sqrt(np.nanmean(np.sum(self.error_mm**2, axis=1))))

    @property
    def max_um(self) -> float:
        """Largest length, µm."""
        return 1e3 * float(np.nanmax(np.hypot(*self.error_mm.T)))


def gains(validation: PathValidation) -> list[Gain]:
    """Return the errors without correction, as measured, and as predicted for the corrected commands.

    All of them are brought onto the wished positions by a rotation and a shift of their own: no distance knows the
    common turn about J1, and the instrument has a frame of its own. Empty for a path that is not corrected.
    """
    if validation.uncorrected_mm is None:
        return []
    last = validation.models[-1]
    places = [
        (f"{model_title(last)}, without correction", validation.uncorrected_mm),
        ("measured, corrected commands", validation.path.measured_mm),
        *(
            (f"{model_title(model)}, corrected commands", model.prediction.position_mm)
            for model in reversed(validation.models)
        ),
    ]
    return [Gain(what, _aligned(validation, place)) for what, place in places]


def _aligned(validation: PathValidation, place_mm: Floats) -> Floats:
    wished = validation.path.command_mm
    rows = validation.compared & np.isfinite(place_mm).all(axis=1)
    off = rigid_fit(place_mm[rows], wished[rows]).apply(place_mm) - wished
    return np.where(rows[:, None], off, np.nan)


def gain_statement(validation: PathValidation) -> Statement | None:
    """Return what the correction gained; None for a path that is not corrected."""
    found = gains(validation)
    if not found:
        return None
    before, measured, predicted, *_ = found
    return Statement(
        Sign.GOOD if measured.rms_um < before.rms_um else Sign.BAD,
        f"The path was driven with corrected commands: {measured.rms_um:.1f} µm rms (2D) from the wished positions "
        f"were measured; {before.rms_um:.1f} µm are predicted without correction, {predicted.rms_um:.1f} µm with it "
        f"({model_title(validation.models[-1])}; frames aligned).",
    )


def gain_blocks(validation: PathValidation) -> list[Block]:
    """Return table and figure of a corrected path; empty for any other."""
    found = gains(validation)
    if not found:
        return []
    columns = (
        Column("what", "position"),
        Column("rms_um", "rms 2D", "µm", _UM),
        Column("max_um", "largest", "µm", _UM),
    )
    rows = tuple((gain.what, gain.rms_um, gain.max_um) for gain in found)
    note = (
        "Each is turned and shifted onto the wished positions by itself. The conventional model knows nothing of "
        "what the error map corrects: it predicts that correction as an error."
    )
    return [
        Table("compensation", "Position minus wished position", columns, rows),
        Paragraph(note),
        gain_figure(validation),
    ]


def gain_figure(validation: PathValidation) -> Figure:
    """Return a panel for each component: measured with correction, predicted without and with it."""
    axis, way = path_axis(validation.path), there(validation.path)
    before, measured, predicted, *_ = gains(validation)
    panels = []
    for place, (symbol, meaning, component) in enumerate(axis.deviations):
        marks: list[Level | Points] = [Level(0.0, Role.AXIS, width=0.6)]
        for gain, ink, marker, label in (
            (before, Role.MUTED, "o", "without correction, predicted"),
            (predicted, Role.CHANGE, ".", "with correction, predicted"),
        ):
            error_um = 1e3 * gain.error_mm[:, component]
            marks.append(
                Points(axis.values_mm, error_um, ink, label, marker=marker, size=3.5, hollow=marker == "o")
            )
        for rows, ink, marker, name in (
            (way, Role.POSITIVE, "x", "there"),
            (~way, Role.NEGATIVE, "+", "back"),
        ):
            if rows.any():
                error_um = 1e3 * measured.error_mm[rows, component]
                label = f"with correction, measured, way {name}"
                marks.append(Points(axis.values_mm[rows], error_um, ink, label, marker=marker, size=4.5))
        title = f"{'ab'[place]}) {meaning}"
        panels.append(Panel(title, Axis(axis.label), Axis("µm", symbol, shared=bool(place)), tuple(marks)))
    return Figure(
        "compensation",
        "What the correction gained",
        "Position minus wished position, frames aligned. Predictions are those of the "
        f"{model_title(validation.models[-1])}.",
        (tuple(panels),),
        aspect=0.5,
        legend_columns=2,
    )

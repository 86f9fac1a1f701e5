"""A result of a calibrated serial arm on the screen Results."""

from typing import ClassVar, Final

from textual.binding import BindingType

from catseye.app.tui.widgets.section_view import Sections, SectionView, section_bindings

SECTIONS: Final[Sections] = (
    ("verdict", "Verdict"),
    ("errors", "Errors"),
    ("parameters", "Parameters"),
    ("deviations", "Deviations"),
    ("models", "Models"),
    ("rejected", "Left out"),
    ("redundant", "Redundant"),
    ("masses", "Masses"),
)


class SerialArmView(SectionView):
    """The sections of a calibration's report."""

    SECTIONS = SECTIONS
    NOTHING: ClassVar = {
        "errors": "the result does not contain errors of single points: calibrate again",
        "deviations": "no parameter of the arm itself was identified",
        "masses": "nothing in this model depends on masses",
        "models": "one model was requested: no other was tried",
        "rejected": "no pose was left out",
        "redundant": "the measurements determine all parameters of the model",
    }
    BINDINGS: ClassVar[list[BindingType]] = section_bindings("serial-arm", SECTIONS)

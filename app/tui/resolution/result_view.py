"""A result of motion resolution on the screen Results."""

from typing import ClassVar, Final

from textual.binding import BindingType

from catseye.app.tui.widgets.section_view import Sections, SectionView, section_bindings

SECTIONS: Final[Sections] = (
    ("verdict", "Verdict"),
    ("errors", "Errors"),
    ("least-steps", "Steps"),
    ("reversal", "Reversal"),
    ("cartesian", "Cartesian"),
    ("recordings", "Recordings"),
    ("flags", "Flags"),
    ("models", "Models"),
)
_NOTHING: Final = {
    "errors": "no test of decreasing steps: run resolution (F3)",
    "least-steps": "no least step",
    "reversal": "no backlash test: run backlash (F3)",
    "cartesian": "no Cartesian test: run resolution-cartesian (F3)",
    "recordings": "the result holds no recording",
    "flags": "nothing was noticed",
    "models": "no prediction beside the result: resolution-model, then predict-resolution -o predicted.json (y)",
}


class ResolutionView(SectionView):
    """The sections of motion resolution's report."""

    SECTIONS = SECTIONS
    NOTHING = _NOTHING
    BINDINGS: ClassVar[list[BindingType]] = section_bindings("resolution", SECTIONS)

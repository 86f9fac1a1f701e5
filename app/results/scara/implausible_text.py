"""What speaks against an identified arm, in sentences."""

import math
from collections.abc import Sequence

from catseye.app.results.numbers import EXPANDED
from catseye.calibration.scara.plausibility.findings import (
    AngleSignReversed,
    AnglesInRadians,
    DeviationOff,
    DisplacementScaled,
    DisplacementSignReversed,
    Joint,
    LinkOff,
    LinksExchanged,
    Mirror,
    Mistake,
    MountingForgotten,
    MountingInRadians,
    MountingOff,
    NamesExchanged,
    Offset,
    OtherLinks,
    OtherSolution,
    PlaceOff,
    PlacesMirrored,
    ReflectorMoved,
    RowsShifted,
    VagueLink,
    Verdict,
    ZeroLost,
)
from catseye.calibration.scara.plausibility.units import unit_of

_MIRRORS: dict[Mirror, str] = {
    "y": "their y has the wrong sign: they stand on the other side of the x axis",
    "x": "their x has the wrong sign: they stand on the other side of the y axis",
    "both": "x and y have the wrong sign: they stand on the opposite side of the arm",
    "exchanged": "x and y are exchanged",
}


def finding_texts(verdict: Verdict) -> list[str]:
    """Return everything that speaks against an arm, the likely mistake first."""
    return [
        *(mistake_text(one) for one in verdict.mistakes),
        *(_break_text(one) for one in verdict.breaks),
        *(_other_text(one) for one in verdict.others),
        *(_vague_text(one) for one in verdict.vague),
    ]


def implausible_text(verdict: Verdict) -> str:
    """Return why an arm is refused, and what to do."""
    if verdict.mistakes:
        beyond = [_break_text(one) for one in verdict.breaks]
        likely = "; or ".join(mistake_text(one) for one in verdict.mistakes)
        shown = f" (as they are: {'; '.join(beyond)})" if beyond else ""
        return f"{likely}; with that corrected the distances fit a plausible arm{shown}"
    return "; ".join(finding_texts(verdict))


def mistake_text(mistake: Mistake) -> str:
    """Return a mistake in words, with what to correct."""
    match mistake:
        case AngleSignReversed(joints):
            return f"the sign of {_angles(joints)} is reversed: turn it round"
        case DisplacementSignReversed():
            return (
                "the sign of displacement_mm is reversed, it falls where the beam grows longer: turn it round"
            )
        case AnglesInRadians(joints):
            return f"{_angles(joints)} seem to be in radians: convert them to degrees"
        case DisplacementScaled(factor):
            return _scale_text(factor)
        case LinksExchanged():
            return "link1_mm and link2_mm are exchanged in the cell file"
        case OtherLinks(link1_mm, link2_mm):
            return (
                f"the distances are those of an arm with links of {link1_mm:.1f} and {link2_mm:.1f} mm: correct "
                "link1_mm and link2_mm in the cell file, or look which arm was measured"
            )
        case RowsShifted(rows):
            way = "below" if rows > 0 else "above"
            return f"displacement_mm stands one row {way} the commands it belongs to: shift the column"
        case NamesExchanged(first, second):
            return f"the reflectors {first} and {second} have each other's name, in the points or in the cell file"
        case PlacesMirrored(mirror):
            return f"the rough places of the reflectors are wrong in the cell file: {_MIRRORS[mirror]}"
        case ZeroLost() | ReflectorMoved():
            return _jump_text(mistake)
        case MountingForgotten() | MountingInRadians() | MountingOff():
            return _mounting_text(mistake)


def _mounting_text(mistake: MountingForgotten | MountingInRadians | MountingOff) -> str:
    where = f"from distance {mistake.row + 1} on ({mistake.reflector}, segment {mistake.segment})"
    match mistake:
        case MountingForgotten():
            return (
                f"{where} the distances are those of an interferometer that was turned by half a turn on J4's "
                "flange: state mount_deg = 180 from there on"
            )
        case MountingInRadians(_, _, _, turned_rad):
            return (
                f"mount_deg = {turned_rad:.4g} seems to be in radians {where}: convert it to degrees, "
                f"{math.degrees(turned_rad):.1f}"
            )
        case MountingOff(_, _, _, stated_rad, found_rad):
            return (
                f"{where} the distances are those of an interferometer that was turned by about "
                f"{math.degrees(found_rad):.0f}° on J4's flange, not by mount_deg = {math.degrees(stated_rad):.4g}: "
                "correct it"
            )


def _jump_text(mistake: ZeroLost | ReflectorMoved) -> str:
    match mistake:
        case ZeroLost(reflector, segment, after, row, jump_mm):
            return (
                f"the count of {reflector}, segment {segment}, jumps by {jump_mm:+.3f} mm between distances "
                f"{after + 1} and {row + 1}: the zero was lost; give the rows from there on a segment number of "
                "their own"
            )
        case ReflectorMoved(reflector, row, (x_mm, y_mm)):
            return (
                f"{reflector} or the interferometer was moved by ({x_mm:+.3f}, {y_mm:+.3f}) mm before distance "
                f"{row + 1}: give the reflector another name from there on"
            )


def _scale_text(factor: float) -> str:
    unit = unit_of(factor)
    if unit is None:
        return (
            f"displacement_mm is {1.0 / factor:.4g} times as large as the arm's links suggest: check its scale, "
            "the wavelength and the links in the cell file"
        )
    return f"displacement_mm seems to be in {unit}: convert it to mm"


def _angles(joints: Sequence[Joint]) -> str:
    return " and ".join(f"θ{joint}" for joint in joints)


def _break_text(found: Offset) -> str:
    match found:
        case LinkOff(link, found_mm, nominal_mm, bound_mm):
            return (
                f"L{link} = {found_mm:.2f} mm, nominal {nominal_mm:g} mm; link_mm = {bound_mm:g} is the bound"
            )
        case DeviationOff(joint, found_rad, bound_rad):
            value, bound = (1e3 * math.degrees(angle) for angle in (found_rad, bound_rad))
            return f"Δθ{joint} reaches {value:.0f} mdeg; deviation_mdeg = {bound:g} is the bound"
        case PlaceOff(reflector, (x_mm, y_mm), _, bound_mm):
            return (
                f"{reflector} comes out at ({x_mm:.1f}, {y_mm:.1f}) mm, {found.off_mm:.0f} mm from its rough place: "
                f"was it moved, or is its place in the cell file wrong? place_mm = {bound_mm:g} is the bound"
            )


def _vague_text(vague: VagueLink) -> str:
    return (
        f"the distances leave L{vague.link} open (U = {EXPANDED * vague.u_mm:.1f} mm, k = 2; link_mm = "
        f"{vague.bound_mm:g} is the bound): measure at more angles of J2, with two of them links and Δθ2 are "
        "hardly told apart"
    )


def _other_text(other: OtherSolution) -> str:
    places = ", ".join(f"{name} ({x:.0f}, {y:.0f})" for name, x, y in other.places_mm)
    better = other.rms_mm < 0.5 * other.own_rms_mm
    fits = "fits better" if better else "fits as well"
    return (
        f"another arm {fits} ({1e3 * other.rms_mm:.1f} µm rms against {1e3 * other.own_rms_mm:.1f} µm): L1 = "
        f"{other.links_mm[0]:.2f} mm, L2 = {other.links_mm[1]:.2f} mm, {places} mm; the start decides: correct the "
        "rough places, or measure at more angles of J2 or to more reflectors"
    )

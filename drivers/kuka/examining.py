"""What a KUKA controller says beyond its state, for `catseye doctor`."""

from typing import Final

from catseye.drivers.kuka import names
from catseye.drivers.kuka.proxy import Proxy
from catseye.drivers.kuka.values import AXES, axes_of, real_of, whole_of
from catseye.drivers.roles.device import Examination

RAISE: Final = (
    "a stop or the guard left it so, or somebody has set it: see that the arm is clear, then raise it at the "
    "smartPAD (program override), no further than the cell's override_cap_percent; a run asks before it does"
)
"""What an override of 0 means to a program that has just connected."""


async def examination_of(proxy: Proxy) -> Examination:
    """Return facts and advice about a connected controller.

    Raises:
        LinkError: lost or silent.
        ProtocolError: garbage came.
    """
    asked = (
        names.AXIS_ACT,
        names.AXIS_MEASURED,
        names.OVERRIDE,
        names.VERSION,
        names.MOST_DEG,
        names.MOST_MM,
    )
    command, measured, override, version, most_deg, most_mm = (await proxy.read_known(asked)).values()
    facts = [f"proxy: {proxy.kind or 'KUKAVARPROXY'}"]
    advice = []
    if command is not None and measured is not None:
        pairs = zip(AXES, axes_of(measured), axes_of(command), strict=True)
        deviations = ", ".join(f"{axis} {1e3 * (is_at - wanted):+z.2f} mdeg" for axis, is_at, wanted in pairs)
        facts.append(f"measured minus commanded: {deviations}")
    else:
        advice.append(f"{names.AXIS_MEASURED} cannot be read: steps need it; check the controller's version")
    if override is not None and whole_of(override) == 0:
        advice.append(f"{names.OVERRIDE} is 0: {RAISE}")
    if version is None:
        advice.append("CATSVARS.dat is not on the controller: copy both programs there, see docs/kuka.md")
    elif whole_of(version) != names.PROGRAM_VERSION:
        advice.append(
            f"CATSKUKA has version {version}, expected {names.PROGRAM_VERSION}: copy both programs again"
        )
    if most_deg is not None and most_mm is not None:
        facts.append(f"largest steps: {real_of(most_deg):g}°, {real_of(most_mm):g} mm")
    return Examination(tuple(facts), tuple(advice))

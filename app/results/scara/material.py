"""Links at 20 °C, from the material's temperature that runs have recorded."""

from collections.abc import Sequence
from statistics import fmean

from catseye.app.cell.model import Material as MaterialSection
from catseye.app.results.runs.run_source import cell_of_run
from catseye.app.results.scara.measured_distances import measured_distances
from catseye.app.results.scara.result import Estimate, Result
from catseye.app.store.reader import RunReader
from catseye.calibration.standards.expansion import Material, at_reference


def with_reference_links(result: Result, readers: Sequence[RunReader]) -> Result:
    """Return a result with the links at 20 °C too, where every point has the material's temperature.

    Args:
        result: identified from these runs.
    """
    section = _common_section(readers)
    temperatures = [point.get("material_c") for reader in readers for point in measured_distances(reader)]
    known = [float(value) for value in temperatures if isinstance(value, int | float)]
    if section is None or not known or len(known) < len(temperatures):
        return result
    material = Material(fmean(known), section.u_temperature_k, section.cte_per_k, section.u_cte_per_k)
    one, two = (_estimate(link, material) for link in (result.link1_mm, result.link2_mm))
    return result.model_copy(
        update={"link1_20c_mm": one, "link2_20c_mm": two, "material_c": material.temperature_c}
    )


def _common_section(readers: Sequence[RunReader]) -> MaterialSection | None:
    """Return the [material] of the runs; None when one has none or another one."""
    sections = [cell_of_run(reader).material for reader in readers]
    return sections[0] if sections and all(section == sections[0] for section in sections) else None


def _estimate(link: Estimate, material: Material) -> Estimate:
    value_mm, u_mm = at_reference(link.value, link.u, material)
    return Estimate(value=value_mm, u=u_mm)

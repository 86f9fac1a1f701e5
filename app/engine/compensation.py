"""Correcting lengths for the air: by the instrument or by the program, never by both."""

from dataclasses import dataclass
from typing import Literal

from catseye.app.cell.model import Air
from catseye.app.errors import MeasurementRejectedError
from catseye.calibration.air import Formula, compensated_mm, outside_nist_range, refractive_index
from catseye.drivers.roles.air import AirSample
from catseye.procedures.kit.records import Json

CompensatedBy = Literal["none", "instrument"]
"""Who corrects before the program sees a length: nobody, or the instrument."""

_NAMES: dict[Formula, str] = {"ciddor": "Ciddor", "edlen": "modified Edlén"}


@dataclass(frozen=True)
class Zero:
    """The count's last zero.

    Attributes:
        index: refractive index of the air then.
        dead_path_mm: length of the beam then, mm.
    """

    index: float
    dead_path_mm: float


@dataclass(frozen=True)
class Correction:
    """What became of one length.

    Attributes:
        displacement_mm: corrected for the air.
        index: refractive index used; None when the instrument corrects.
        zero: the zero used; None when the instrument corrects.
        formula: of the index; None when the instrument corrects.
    """

    displacement_mm: float
    index: float | None = None
    zero: Zero | None = None
    formula: Formula | None = None


class Compensation:
    """Corrects the lengths of one interferometer.

    Args:
        done_by: who has corrected a length before it comes here.
    """

    def __init__(self, done_by: CompensatedBy, rule: Air) -> None:
        self.by_program = done_by == "none"
        self._rule = rule
        self._zero: Zero | None = None

    @property
    def sentence(self) -> str:
        """Who compensates, for run, report and doctor."""
        if not self.by_program:
            return (
                "The instrument corrects its lengths for the air; the program adds nothing to them, "
                "neither an index nor a dead-path term."
            )
        rule = self._rule
        co2 = f", {rule.co2_ppm:g} ppm CO2" if rule.formula == "ciddor" else ""
        return (
            f"The program corrects the lengths for the air: {_NAMES[rule.formula]}{co2}, vacuum wavelength "
            f"{rule.vacuum_wavelength_nm:.9g} nm, dead path = planned length of the beam at each zero."
        )

    def facts(self) -> dict[str, Json]:
        """Return what a run stores about it."""
        rule = self._rule
        known: dict[str, Json] = {
            "formula": rule.formula,
            "co2_ppm": rule.co2_ppm,
            "vacuum_wavelength_nm": rule.vacuum_wavelength_nm,
        }
        by = "program" if self.by_program else "instrument"
        return {"by": by, "sentence": self.sentence, **(known if self.by_program else {})}

    def zeroed(self, air: AirSample, dead_path_mm: float) -> Zero | None:
        """Remember the air and the beam's length at a zero; None when the instrument corrects.

        Raises:
            MeasurementRejectedError: the air is not known.
        """
        self._zero = Zero(self._index(air), dead_path_mm) if self.by_program else None
        return self._zero

    def correct(self, raw_mm: float, air: AirSample) -> Correction:
        """Return a length corrected for the air, once.

        Args:
            raw_mm: as the instrument gave it, mm.

        Raises:
            MeasurementRejectedError: the air is not known.
        """
        if not self.by_program:
            return Correction(raw_mm)
        index = self._index(air)
        # A count that was never zeroed is no distance; the measurement is not ok whatever stands here.
        zero = self._zero or Zero(index, 0.0)
        corrected_mm = compensated_mm(raw_mm, index, zero.index, zero.dead_path_mm)
        return Correction(corrected_mm, index, zero, self._rule.formula)

    def doubt(self, air: AirSample) -> str | None:
        """Return what an operator should know about a sample of the air, None when all is well."""
        missing = missing_quantities(air)
        if missing:
            return (
                f"the air sensor gives no {' and no '.join(missing)}: the instrument corrects its lengths by itself, "
                "but nobody can check or repeat that later; see the sensor and [environment]"
            )
        if not self.by_program or air.temperature_c is None or air.pressure_hpa is None:
            return None
        left = outside_nist_range(self._rule.vacuum_wavelength_nm, air.temperature_c, air.pressure_hpa)
        return left and f"{left}, for which the uncertainty of the refractive index is stated"

    def _index(self, air: AirSample) -> float:
        missing = missing_quantities(air)
        if missing or air.temperature_c is None or air.pressure_hpa is None or air.humidity_percent is None:
            raise MeasurementRejectedError(
                f"nothing corrects the lengths for the air: the instrument does not, and the air sensor gives no "
                f"{' and no '.join(missing)} (270 ppm would be missing): repair the sensor, set its registers in "
                "[environment], or let the instrument correct and say so in its profile or settings"
            )
        rule = self._rule
        state = (air.temperature_c, air.pressure_hpa, air.humidity_percent, rule.co2_ppm)
        try:
            return float(refractive_index(rule.vacuum_wavelength_nm, *state, formula=rule.formula))
        except ValueError as error:
            raise MeasurementRejectedError(f"the air cannot be corrected for: {error}") from error


def missing_quantities(air: AirSample) -> list[str]:
    """Return the quantities that a sample of the air lacks."""
    values = {
        "temperature": air.temperature_c,
        "pressure": air.pressure_hpa,
        "humidity": air.humidity_percent,
    }
    return [name for name, value in values.items() if value is None]

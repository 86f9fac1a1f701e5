"""A calibration written by hand: figures that nobody computed, each of them different."""

from datetime import UTC, datetime

from catseye.app.results.provenance import Provenance
from catseye.app.results.serial_arm.result import (
    CandidatePart,
    FitPart,
    FramesPart,
    HeldOutPart,
    ParameterPart,
    RejectedPart,
    SerialArmResult,
)


def sample_calibration() -> SerialArmResult:
    """Return a result of an IRB 120 with three identified parameters and one that is held."""
    return SerialArmResult(
        arm="irb120",
        model="geometric+compliance",
        parameters=[
            _parameter("base.x_mm", 1500.25, 0.031, "mm", None),
            _parameter("J2.a_mm", 0.125, 0.012, "mm", 0.0),
            _parameter("J2.compliance_rad_per_nmm", 3.2e-8, 4e-9, "rad/(N·mm)", 0.0),
            _parameter("J3.d_mm", 0.0, 0.0, "mm", 0.0, identified=False),
        ],
        null_directions=[["J2.d_mm", "J3.d_mm"]],
        correlation=[[1.0, 0.5, 0.1], [0.5, 1.0, -0.2], [0.1, -0.2, 1.0]],
        fit=FitPart(n_rows=114, n_parameters=3, rms_mm=0.0385, lack_of_fit=True),
        cross_validation=HeldOutPart(mean_mm=0.146, max_mm=0.437),
        rejected=[RejectedPart(pose="pose 17", error_mm=4.2, probability=1e-9)],
        provenance=Provenance(
            runs=["poses.csv"],
            software="catseye",
            created=datetime(2026, 11, 25, tzinfo=UTC).isoformat(),
            simulated=True,
        ),
        candidates=[
            CandidatePart(model="geometric", mean_mm=0.41),
            CandidatePart(model="geometric+compliance", mean_mm=0.146),
            CandidatePart(model="maps", mean_mm=None, reason="too few poses for the nodes of a map"),
        ],
        frames=FramesPart(mean_mm=3.168, std_mm=0.9, max_mm=5.51, parameters=[]),
    )


def _parameter(
    name: str, value: float, u: float, unit: str, nominal: float | None, *, identified: bool = True
) -> ParameterPart:
    return ParameterPart(name=name, value=value, u=u, unit=unit, nominal=nominal, identified=identified)

"""What a result file keeps of the residuals of a scan."""

from pydantic import BaseModel, ConfigDict

from catseye.calibration.core.blockwise.residual_sums import ResidualSums


class ScanSegments(BaseModel):
    """Residuals by segment, as columns."""

    model_config = ConfigDict(frozen=True, extra="ignore")

    reflector: list[str]
    segment: list[int]
    n_points: list[int]
    mean_um: list[float]
    rms_um: list[float]
    largest_um: list[float]


class ScanPart(BaseModel):
    """Residuals of all distances, summed up; `residuals` of the result holds an even sample of them."""

    model_config = ConfigDict(frozen=True, extra="ignore")

    n_points: int
    n_sample: int
    segments: ScanSegments
    histogram_from_um: float
    histogram_to_um: float
    histogram: list[int]


def scan_part(residuals: ResidualSums, dead_paths: tuple[tuple[str, int], ...], n_sample: int) -> ScanPart:
    """Return summed residuals as a result file states them."""
    return ScanPart(
        n_points=residuals.rows,
        n_sample=n_sample,
        segments=ScanSegments(
            reflector=[name for name, _ in dead_paths],
            segment=[segment for _, segment in dead_paths],
            n_points=residuals.count.tolist(),
            mean_um=(1e3 * residuals.total_mm / residuals.count).tolist(),
            rms_um=(1e3 * (residuals.square_mm2 / residuals.count) ** 0.5).tolist(),
            largest_um=(1e3 * residuals.largest_mm).tolist(),
        ),
        histogram_from_um=-1e3 * residuals.half_width_mm,
        histogram_to_um=1e3 * residuals.half_width_mm,
        histogram=residuals.histogram.tolist(),
    )

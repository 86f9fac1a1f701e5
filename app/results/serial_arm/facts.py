"""What `predict` and `compensate` of a serial arm say with `--json` of the files that they write."""

from catseye.app.results.document import Document


class PosePrediction(Document):
    """Where an arm goes at poses.

    Attributes:
        output: the predicted CSV.
        model: of the result.
        joints: that it holds for: as commanded, or as read back.
        rows: of the poses.
        median_u_mm: standard uncertainty of a coordinate, or of a distance.
        max_u_mm: of the same.
    """

    output: str
    model: str
    joints: str
    rows: int
    median_u_mm: float
    max_u_mm: float


class PoseCompensation(Document):
    """Corrected commands of poses.

    Attributes:
        output: files.
        form: name of their format.
        rows: of the poses.
        compensated: poses that have a correction.
        mean_uncorrected_mm: by which they would be missed without it.
        max_uncorrected_mm: of the same.
        refused: poses without a correction, with the reason.
    """

    output: list[str]
    form: str
    rows: int
    compensated: int
    mean_uncorrected_mm: float
    max_uncorrected_mm: float
    refused: list[str]

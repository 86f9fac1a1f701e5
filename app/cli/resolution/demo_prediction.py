"""What the tests of the joints predict of the steps of the tool, for the comparison with its measured steps."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from catseye.app.cell.arm import arm_description
from catseye.app.cluster.share import InThisProcess, Share
from catseye.app.files.atomic import write_atomically
from catseye.app.results.resolution.cartesian_prediction import Prediction, predicted_resolution
from catseye.app.results.resolution.joint_tables import write_joint_tables
from catseye.app.results.resolution.modelling import model_arm
from catseye.app.results.resolution.predicted import write_predicted
from catseye.app.results.resolution.result import AnyTest, ResolutionResult, write_resolution
from catseye.calibration.resolution.cartesian_steps import StepSeries
from catseye.calibration.resolution.predictor import PredictionMethod

_METHOD: Final = PredictionMethod(series=StepSeries(largest_mm=0.1))


def predict_tool(
    folder: Path, arm: str, pose_deg: Sequence[float], results: Sequence[ResolutionResult], share: Share
) -> list[Path]:
    """Model the joints around a pose and predict the steps of the tool there; return prediction and tables.

    Args:
        folder: where the files are written.
        arm: name of the arm's description.
        pose_deg: of the Cartesian test, shape (n,).
        results: tests of all joints.
        share: fits the joints' models.
    """
    tables, poses, predicted = (folder / name for name in ("tables.csv", "poses.csv", "predicted.json"))
    modelled = folder / "modelled.json"
    tests = around([test for result in results for test in result.tests])
    write_resolution(results[0].model_copy(update={"tests": tests}), modelled)
    models = model_arm([modelled], share)
    write_joint_tables(models.tables, tables, simulated=models.simulated)
    description = arm_description(arm)
    head = ",".join(["pose", *(f"q{number}_deg" for number in range(1, len(pose_deg) + 1))])
    write_atomically(poses, "\n".join([head, ",".join(["P1", *map(str, pose_deg)]), ""]))
    write_predicted(
        predicted_resolution(Prediction(description, tables, poses, _METHOD), InThisProcess()), predicted
    )
    return [predicted, tables]


def around(tests: Sequence[AnyTest]) -> list[AnyTest]:
    """Return the tests of joints at K2 … K4: the pose lies between these, and models of fewer are fitted sooner."""
    places: dict[str, list[float]] = {}
    for test in tests:
        if test.position is not None and test.position not in places.setdefault(test.joint, []):
            places[test.joint].append(test.position)
    inner = {joint: sorted(positions)[1:-1] for joint, positions in places.items()}
    return [test for test in tests if test.position in inner.get(test.joint, [])]

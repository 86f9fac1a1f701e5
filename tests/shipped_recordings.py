"""Make the recordings that are shipped with the program: every joint of the KR210 at K1 … K5 on its emulated bench.

Run as `python -m tests.shipped_recordings`, or `make shipped-recordings`. Each place is a bench of its own with the
arm of one seed, so that any of them can be made again by itself.
"""

import json
import sys
from collections.abc import Iterator, Sequence
from typing import Any, Final

from catseye.app.cell.arm import shipped_arm
from catseye.app.results.resolution.actuation import actuation_of
from catseye.app.results.resolution.recorded_runs import evaluate_series
from catseye.app.results.resolution.result import RESOLUTION_FORMAT, AnyTest
from catseye.app.results.resolution.shipped import SHIPPED, shipped_file
from catseye.calibration.resolution.decaying import THRESHOLD_PERCENT
from catseye.procedures.resolution.backlash import Backlash, BacklashParams
from catseye.procedures.resolution.campaign_plan import CampaignPlan
from catseye.procedures.resolution.iso import IsoParams, ResolutionIso
from catseye.procedures.resolution.resolution import Resolution, ResolutionParams
from tests.virtual_bench import ARM, BENCH, arm_truth, recorded

SEED: Final = 1
"""That of `catseye demo`: unless told otherwise, it measures the arm of these recordings."""

JOINTS: Final = ("A1", "A2", "A3", "A4", "A5", "A6")
POSITIONS: Final = ("K1", "K2", "K3", "K4", "K5")

_DIGITS: Final = 6
"""What is beyond depends on the order in which a processor adds, and says nothing."""


def chosen(joint: str, positions: Sequence[str]) -> dict[str, Any]:
    """Return parameters of a joint's tests at positions."""
    place: dict[str, Any] = {"joints": [joint], "positions": list(positions)}
    if joint == "A4":
        # A5 stands at 90° while A4 is tested (resolution paper, section 3.2), others in mid-range.
        middle = [(axis.low + axis.high) / 2.0 for axis in BENCH.arm.axes]
        place["pose_deg"] = [*middle[:4], 90.0, middle[5]]
    return place


def plans(joint: str, position: str) -> tuple[CampaignPlan, ...]:
    """Return what is tested at a place: decaying steps both ways, steps by ISO 230, backlash."""
    place = chosen(joint, [position])
    return (
        Resolution().plan(BENCH, ResolutionParams.model_validate(place)),
        ResolutionIso().plan(BENCH, IsoParams.model_validate(place)),
        Backlash().plan(BENCH, BacklashParams.model_validate(place)),
    )


def made_at(joint: str, position: str, seed: int = SEED) -> Iterator[dict[str, Any]]:
    """Yield the tests of a place of the arm of a seed, as the file has them."""
    truth = arm_truth(seed)
    for kind, plan in enumerate(plans(joint, position)):
        number = kind + 3 * (POSITIONS.index(position) + len(POSITIONS) * JOINTS.index(joint))
        series = recorded(truth, plan, plan.places[0], 1000 * seed + number)
        for test in evaluate_series(series, "shipped", THRESHOLD_PERCENT):
            yield as_filed(test)


def as_filed(test: AnyTest) -> dict[str, Any]:
    """Return a test as the file has it: without its staircase, and without what each step's u is."""
    marked = test.model_copy(update={"shipped": True})
    row: dict[str, Any] = marked.model_dump(
        mode="json",
        by_alias=True,
        exclude_defaults=True,
        exclude={"staircase": True, "moves": {"__all__": {"u"}}},
    )
    return {key: _rounded(value) for key, value in row.items()}


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.{_DIGITS}g}")
    if isinstance(value, dict):
        return {key: _rounded(one) for key, one in value.items()}
    return [_rounded(one) for one in value] if isinstance(value, list) else value


def result_text(joint: str, seed: int = SEED) -> str:
    """Return the file of a joint, a test a line."""
    tests = [test for position in POSITIONS for test in made_at(joint, position, seed)]
    actuation = [one.model_dump(mode="json") for one in actuation_of(shipped_arm(ARM)) if one.joint == joint]
    lines = ",\n".join(json.dumps(test, ensure_ascii=False, separators=(",", ":")) for test in tests)
    head = json.dumps(
        {
            "format": RESOLUTION_FORMAT,
            "arm": ARM,
            "actuation": actuation,
            # No date and no version: the same program makes the same file on any day.
            "provenance": {"runs": [], "software": "catseye", "created": "shipped", "simulated": True},
        }
    )
    return f'{head[:-1]}, "tests": [\n{lines}\n]}}\n'


def main() -> None:
    """Write the files of all joints."""
    SHIPPED.mkdir(exist_ok=True)
    for joint in JOINTS:
        path = shipped_file(ARM, joint)
        path.write_text(result_text(joint), encoding="utf-8")
        sys.stdout.write(f"{path} written\n")


if __name__ == "__main__":
    main()

"""Reversal errors of files of target deviations, against deviations chosen by hand."""

from collections.abc import Callable
from pathlib import Path

import pytest

from catseye.app.errors import UsageError
from catseye.app.results.resolution.target_reversal import reversal_of_targets

_TARGETS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5)
_SCATTER = (0.1, -0.1, 0.1, -0.1)


def _forward(target: int) -> float:
    return 0.5 * target


def _file(
    tmp_path: Path, name: str = "axis.rtl", runs: int = 4, change: Callable[[str], str] = lambda text: text
) -> Path:
    """Return a file whose backward runs lie 5.0 above the forward ones between the ends, in the order N … 1."""
    lines = [
        "HEADER::",
        "File type   :Linear",
        "TARGET DATA::",
        "Filetype:  x",
        f"Target-count: {len(_TARGETS)}",
    ]
    lines += [
        "Targets :",
        *(f"  {target:.4f}" for target in _TARGETS),
        "Flags: 0",
        "RUNS::",
        f"Run-count: {runs}",
    ]
    lines += ["DEVIATIONS::", "Run Target Data:"]
    for run in range(1, runs + 1):
        back = run % 2 == 0
        order = range(len(_TARGETS), 0, -1) if back else range(1, len(_TARGETS) + 1)
        lines += [
            f"  {run}   {target}   {_forward(target) + 5.0 * back + _SCATTER[(run - 1) // 2]:.6f}"
            for target in order
        ]
    path = tmp_path / name
    path.write_text(change("\r\n".join([*lines, "EQUIPMENT::", ""])), "latin-1", newline="")
    return path


def test_lost_motion_is_positive_and_between_the_ends(tmp_path: Path) -> None:
    unit, reversal, targets = reversal_of_targets(_file(tmp_path), None)
    assert unit == "mm"
    assert reversal.value == pytest.approx(5e-3)
    assert [target["position"] for target in targets] == pytest.approx([0.1, 0.2, 0.3, 0.4])
    assert [target["reversal"] for target in targets] == pytest.approx([5e-3] * 4)
    assert reversal.valid is None


def test_runs_downwards_first_lose_motion_positively_too(tmp_path: Path) -> None:
    # Odd runs approach 0.5 … 0 downwards: there a joint with play is above, backwards (upwards) below.
    path = _file(tmp_path)
    lines = path.read_text("latin-1").splitlines()
    at = lines.index("Targets :") + 1
    lines[at : at + len(_TARGETS)] = reversed(lines[at : at + len(_TARGETS)])
    path.write_text("\n".join(lines), "latin-1")
    _, reversal, targets = reversal_of_targets(path, None)
    assert reversal.value == pytest.approx(-5e-3)
    assert [target["reversal"] for target in targets] == pytest.approx([-5e-3] * 4)


def test_u_comes_from_the_repeats(tmp_path: Path) -> None:
    """Each side: s = 0.1·√2 µm of two runs, so s²/2 = 0.01 µm²; the mean of four targets of both sides."""
    _, reversal, _ = reversal_of_targets(_file(tmp_path), None)
    assert reversal.u == pytest.approx(1e-3 * (4 * 2 * 0.01) ** 0.5 / 4)


def test_angular_deviations_need_their_unit(tmp_path: Path) -> None:
    path = _file(tmp_path, "axis.rta")
    with pytest.raises(
        UsageError, match=r"unit of its deviations is not certain; .*--deviation-unit mrad\|urad"
    ):
        reversal_of_targets(path, None)
    unit, reversal, _ = reversal_of_targets(path, "arcsec")
    assert unit == "deg"
    assert reversal.value == pytest.approx(5.0 / 3600.0)


@pytest.mark.parametrize("runs", [2, 3])
def test_a_direction_with_one_run_leaves_u_open(tmp_path: Path, runs: int) -> None:
    _, reversal, _ = reversal_of_targets(_file(tmp_path, runs=runs), None)
    # The third run, forwards, lies 0.2 µm below the first: their mean is 0.1 µm nearer to the one backwards.
    assert reversal.value == pytest.approx(5e-3 if runs == 2 else 5.1e-3)
    assert reversal.u is None


def test_a_single_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="its only run goes one way"):
        reversal_of_targets(_file(tmp_path, runs=1), None)


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("Run-count: 4", "Run-count: 5", "42: 'EQUIPMENT::' is not a run"),
        (
            "Target-count: 6",
            "Target-count: 9",
            "'Flags: 0' holds no targets, but Target-count is 9",
        ),
        ("Target-count: 6", "", "states no Target-count"),
        ("  1   2   ", "  1   9   ", "'1   9   1.100000' is not a run .* target .* and deviation"),
        ("Run Target Data:", "Data:", "has no line Run target data"),
        ("  1   1   0.600000\r\n", "  1   1   many\r\n", "'1   1   many' is not a run"),
        ("  1   1   0.600000\r\n", "  1   1   inf\r\n", "'1   1   inf' is not a run"),
        ("  1   1   0.600000\r\n", "  1.5   1   0.1\r\n", "'1.5   1   0.1' is not a run"),
        ("Run-count: 4", "Run-count: 2", "numbers go on behind 2 runs of 6 targets"),
        ("  0.1000", "  nan", "'nan' holds no targets"),
        ("  0.1000", "  0.3000", "the targets neither grow nor fall"),
    ],
)
def test_damaged_files_name_the_place(tmp_path: Path, old: str, new: str, complaint: str) -> None:
    with pytest.raises(UsageError, match=complaint):
        reversal_of_targets(_file(tmp_path, change=lambda text: text.replace(old, new)), None)


def test_decimal_commas_are_understood(tmp_path: Path) -> None:
    _, reversal, _ = reversal_of_targets(_file(tmp_path, change=lambda text: text.replace(".", ",")), None)
    assert reversal.value == pytest.approx(5e-3)


@pytest.mark.parametrize(
    ("runs", "said"),
    [
        ("9" * 5000, "no Run-count"),
        ("999999999", "than the file has lines"),
        ("10", "than the file has lines"),
    ],
)
def test_more_runs_than_the_file_has_lines_are_refused(tmp_path: Path, runs: str, said: str) -> None:
    # Room for all of them would take terabytes.
    path = _file(tmp_path, change=lambda text: text.replace("Run-count: 4", f"Run-count: {runs}"))
    with pytest.raises(UsageError, match=rf"axis\.rtl: .*{said}"):
        reversal_of_targets(path, None)

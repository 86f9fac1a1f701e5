"""validate against measurements made by plain trigonometry, and what it refuses."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from catseye.app.cell.scara.sections import Measurement
from catseye.app.cli.scara.validate import Wanted, validate_path
from catseye.app.errors import MeasurementRejectedError, UsageError
from catseye.app.results.scara.measured import travel_of
from catseye.app.results.scara.result import write_result
from catseye.app.results.scara.validation import TAKE_UP_DEG
from catseye.app.results.scara.validation_of_files import validate_files
from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.core.types import Floats
from tests.unit.app.cli.arms import bare, stored, text_file
from tests.unit.app.render.page_reader import read_page
from tests.unit.app.results.scara import sample

NOMINAL = (325.0, 225.0)
TURN, SHIFT = math.radians(20.0), (1500.0, -800.0)

JOINTS = "theta1_deg,theta2_deg,direction1,direction2,x_meas_mm,y_meas_mm"

Command = tuple[float, float, int, int]


def place(theta1_deg: float, theta2_deg: float, link1_mm: float, link2_mm: float) -> tuple[float, float]:
    one, both = math.radians(theta1_deg), math.radians(theta1_deg + theta2_deg)
    return (
        link1_mm * math.cos(one) + link2_mm * math.cos(both),
        link1_mm * math.sin(one) + link2_mm * math.sin(both),
    )


def true_place(command: Command) -> tuple[float, float]:
    """Return where the arm of `arms.bare` really stands, by hand."""
    one, two, s1, s2 = command
    first = (10.0 if s1 > 0 else -10.0) + 20.0 * one / 90.0
    return place(one + 1e-3 * first, two + 0.005 * s2, 325.1, 224.9)


def in_frame(xy: tuple[float, float]) -> tuple[float, float]:
    """Return a position in the frame of a tracker that stands turned by 20°, somewhere else."""
    x, y = xy[0] - 12.0, xy[1] + 7.0
    cosine, sine = math.cos(TURN), math.sin(TURN)
    return cosine * x - sine * y + SHIFT[0], sine * x + cosine * y + SHIFT[1]


def way(count: int = 12) -> list[Command]:
    """Return commands there and back, J1 upwards first, J2 the other way round."""
    there = [(8.0 + 6.0 * i, 100.0 - 7.0 * i, 1, -1) for i in range(count)]
    return there + [(one, two, -1, 1) for one, two, _, _ in reversed(there)]


def joint_file(
    folder: Path,
    commands: list[Command],
    factor: float = 1.0,
    exchanged: bool = False,
    u_mm: float | None = None,
    noise: Floats | None = None,
) -> Path:
    lines = [JOINTS + (",u_mm" if u_mm else "")]
    for i, command in enumerate(commands):
        x, y = in_frame(true_place(command))
        dx, dy = (0.0, 0.0) if noise is None else noise[i]
        seen = [factor * (x + dx), factor * (y + dy)]
        seen = seen[::-1] if exchanged else seen
        cells = [*command, *(f"{value:.9f}" for value in seen), *([u_mm] if u_mm else [])]
        lines.append(",".join(str(cell) for cell in cells))
    return text_file(folder, "\n".join(lines) + "\n", "measured.csv")


def facts(capsys: pytest.CaptureFixture[str], *arguments: object, limit: float | None = None) -> dict:  # type: ignore[type-arg]  # JSON
    result, measured, reference = arguments
    assert isinstance(result, Path)
    assert isinstance(measured, Path)
    assert reference is None or isinstance(reference, Path)
    validate_path(Wanted(result, measured, reference, limit=limit, as_json=True), None)
    found = json.loads(capsys.readouterr().out)
    assert isinstance(found, dict)
    return found


def test_the_true_arm_leaves_nothing_in_any_frame(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    measured = joint_file(tmp_path, way())
    nominal = {**bare("conventional"), "link1_mm": {"value": 325.0, "u": 0.0}}
    nominal |= {"link2_mm": {"value": 225.0, "u": 0.0}, "theta20_mdeg": {"value": 0.0, "u": 0.0}}
    reference = stored(tmp_path, nominal, "nominal.json")
    found = facts(capsys, stored(tmp_path, bare()), measured, reference)
    first, last = found["models"]
    assert (found["rows"], found["compared"]) == (24, 24)
    assert last["rms_um"] < 1e-3
    assert first["rms_um"] > 20.0
    assert found["ratio"] == pytest.approx(last["rms_um"] / first["rms_um"])
    # The true arm leaves nothing, and what it stands for is said in a few words.
    left = found["said"][0]
    assert (left["sign"], left["short"]) == (
        "good",
        f"conventional model {first['rms_um']:.1f} µm → error map 0.0 µm",
    )
    alignment = last["alignment"]
    assert alignment["rotation_mdeg"]["value"] == pytest.approx(-20e3, abs=1e-3)
    # The frame's origin lies at (12, −7) mm less the shift turned back.
    cosine, sine = math.cos(-TURN), math.sin(-TURN)
    expected = (
        12.0 - (cosine * SHIFT[0] - sine * SHIFT[1]),
        -7.0 - (sine * SHIFT[0] + cosine * SHIFT[1]),
    )
    assert (alignment["shift_x_mm"]["value"], alignment["shift_y_mm"]["value"]) == pytest.approx(
        expected, abs=1e-5
    )


def test_the_largest_residual_is_located_and_judged_against_uncertainty(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    commands = way()
    noise = np.random.default_rng(1).normal(0.0, 0.02, (len(commands), 2))
    noise[17] = (0.3, 0.0)
    found = facts(
        capsys, stored(tmp_path, bare()), joint_file(tmp_path, commands, u_mm=0.02, noise=noise), None
    )
    (model,) = found["models"]
    # Line 1 is the header.
    assert model["max_line"] == 19
    assert model["max_um"] == pytest.approx(300.0, rel=0.15)
    assert model["probability"] < 1e-3
    assert "explain" in found["verdict"][0]


def test_noise_as_stated_agrees(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    commands = way()
    noise = np.random.default_rng(2).normal(0.0, 0.02, (len(commands), 2))
    found = facts(
        capsys, stored(tmp_path, bare()), joint_file(tmp_path, commands, u_mm=0.02, noise=noise), None
    )
    (model,) = found["models"]
    assert model["probability"] > 0.01
    assert 0.5 < model["share_explained"] < 2.0
    assert model["within_2u"] > 0.85
    assert "agrees with the uncertainties of prediction, arm and instrument" in found["verdict"][0]


def test_a_limit_that_is_exceeded_rejects(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    commands = way()
    # 24 rows with 20 µm in x and in y leave 26 µm of 2-D rms, less or more by chance.
    noise = np.random.default_rng(3).normal(0.0, 0.02, (len(commands), 2))
    result, measured = stored(tmp_path, bare()), joint_file(tmp_path, commands, noise=noise)
    assert facts(capsys, result, measured, None, limit=60.0)["within_limit"]
    with pytest.raises(MeasurementRejectedError, match=r"leaves 3\d\.\d µm .*more than the limit of 10 µm"):
        facts(capsys, result, measured, None, limit=10.0)
    assert json.loads(capsys.readouterr().out)["within_limit"] is False


@pytest.mark.parametrize(
    ("factor", "unit"), [(1e3, "µm"), (1e-3, "m"), (0.1, "cm"), (1.0 / 25.4, "inches"), (25.4, "inches")]
)
def test_another_unit_is_named(tmp_path: Path, factor: float, unit: str) -> None:
    with pytest.raises(UsageError, match=rf"times as far as the commands.*{unit}.*convert"):
        validate_files(stored(tmp_path, bare()), joint_file(tmp_path, way(), factor), None, "right", "1,1")


@pytest.mark.parametrize(("factor", "unit"), [(math.pi / 180.0, "rad"), (1e3, "mdeg")])
def test_commands_in_another_unit_are_named(tmp_path: Path, factor: float, unit: str) -> None:
    path = joint_file(tmp_path, way())
    head, *lines = path.read_text(encoding="utf-8").splitlines()
    cells = [line.split(",") for line in lines]
    converted = [",".join([*(str(factor * float(one)) for one in row[:2]), *row[2:]]) for row in cells]
    path.write_text("\n".join([head, *converted]) + "\n", encoding="utf-8")
    with pytest.raises(UsageError, match=f"theta1_deg, theta2_deg seem to be in {unit}: convert"):
        validate_files(stored(tmp_path, bare()), path, None, "right", "1,1")


def test_a_mirrored_frame_is_refused_on_a_planar_path(tmp_path: Path) -> None:
    result = stored(tmp_path, bare())
    with pytest.raises(UsageError, match=r"only with x and y exchanged.*exchange x_meas_mm and y_meas_mm"):
        validate_files(result, joint_file(tmp_path, way(), exchanged=True), None, "right", "1,1")


def test_a_mirrored_frame_is_refused_on_a_straight_line(tmp_path: Path) -> None:
    conventional, error_map = sample.results()
    write_result(error_map, tmp_path / "map.json")
    path = sample.path()
    rows = [
        f"{x:.6f},{y:.6f},{b:.6f},{a:.6f}"
        for (x, y), (a, b) in zip(path.command_mm, path.measured_mm, strict=True)
    ]
    text = "x_mm,y_mm,x_meas_mm,y_meas_mm\n" + "\n".join(rows) + "\n"
    with pytest.raises(UsageError, match="left-handed; exchange x_meas_mm and y_meas_mm"):
        validate_files(tmp_path / "map.json", text_file(tmp_path, text), None, "right", "1,1")
    assert conventional.model == "conventional"


def test_points_of_another_path_name_their_line(tmp_path: Path) -> None:
    path = joint_file(tmp_path, way())
    lines = path.read_text(encoding="utf-8").splitlines()
    lines[4], lines[5] = (
        ",".join([*a.split(",")[:4], *b.split(",")[4:]])
        for a, b in ((lines[4], lines[5]), (lines[5], lines[4]))
    )
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    with pytest.raises(
        UsageError, match=r"measured\.csv:[56]: the measured position lies .* mm from its command"
    ):
        validate_files(stored(tmp_path, bare()), path, None, "right", "1,1")


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        (
            "reflector,segment,displacement_mm\nP1,0,1.0\n",
            "distances to reflectors, and positions are needed",
        ),
        ("theta1_deg,theta2_deg,x_meas_mm,y_meas_mm\n1,2,3,4\n", "column direction1, direction2 is missing"),
        ("x_mm,y_mm\n1,2\n", "column x_meas_mm, y_meas_mm is missing"),
        ("x_mm,y_mm,x_meas_mm,y_meas_mm\n400,0,1,1\n400,10,1,11\n", r"holds 2 row\(s\).*4 positions or more"),
        ("x_mm,y_mm,x_meas_mm,y_meas_mm\n" + "400,0,1,1\n" * 5, "all positions lie in one place"),
        (
            "x_mm,y_mm,x_meas_mm,y_meas_mm\n" + "400,0,1,1\n" * 4 + "600,0,1,1\n",
            ":6: the position .* out of reach",
        ),
        (
            "x_mm,y_mm,x_meas_mm,y_meas_mm,u_mm\n"
            + "".join(f"400,{y},400,{y},8.5\n" for y in (0, 10, 20, 30)),
            "u_mm = 8.5 is more than 1 mm: it seems to be in µm",
        ),
    ],
)
def test_files_that_cannot_be_compared_name_the_remedy(tmp_path: Path, text: str, complaint: str) -> None:
    with pytest.raises(UsageError, match=complaint):
        validate_files(stored(tmp_path, bare()), text_file(tmp_path, text), None, "right", "1,1")


def test_too_few_rows_inside_the_nodes(tmp_path: Path) -> None:
    commands = [(one, 60.0, 1, 1) for one in (-10.0, -5.0, 0.0, 5.0, 10.0)]
    with pytest.raises(InsufficientPointsError, match=r"3 of 5 rows.*takes 4 or more"):
        validate_files(stored(tmp_path, bare()), joint_file(tmp_path, commands), None, "right", "1,1")


def test_rows_outside_or_just_reversed_are_excluded_and_reported(tmp_path: Path) -> None:
    commands: list[Command] = [(float(one), 60.0, 1, 1) for one in range(0, 100, 5)]
    commands += [(94.5, 60.0, -1, 1), (80.0, 60.0, -1, 1), (79.5, 60.0, -1, 1)]
    commands += [(79.7, 60.0, 1, 1), (20.0, 60.0, -1, 1)]
    found = validate_files(stored(tmp_path, bare()), joint_file(tmp_path, commands), None, "right", "1,1")
    assert np.flatnonzero(~found.validation.compared).tolist() == [19, 20, 23]
    outside, loose = found.left_out
    assert "θ1 (94.50°…95.00°) beyond its nodes 0°…90° in lines 21–22" in outside
    # From 95° to 94.5° is half a degree, from 79.5° to 79.7° too little as well.
    assert "2 of 25 rows are left out" in loose
    assert "lines 22, 25" in loose
    assert Measurement.model_fields["take_up_deg"].default == TAKE_UP_DEG


def test_a_first_row_with_a_contradicted_state_is_excluded(tmp_path: Path) -> None:
    """J1 goes up and J2 down from the first position on, and the option says that both came from below."""
    commands, lines = way()[:12], ["x_mm,y_mm,x_meas_mm,y_meas_mm"]
    for one, two, s1, s2 in commands:
        cells = (*place(one, two, *NOMINAL), *in_frame(true_place((one, two, s1, s2))))
        lines.append(",".join(f"{cell:.9f}" for cell in cells))
    measured, result = text_file(tmp_path, "\n".join(lines), "measured.csv"), stored(tmp_path, bare())
    guessed = validate_files(result, measured, None, "right", "1,1")
    # The bare map has a play of 20 mdeg in J1 and of 10 in J2: counted in, one row would leave 40 µm and more.
    assert np.flatnonzero(~guessed.validation.compared).tolist() == [0]
    assert guessed.validation.models[0].comparison.max_um < 1e-3
    assert any("give --start-direction=1,-1. It is left out" in text for text in guessed.remarks)
    stated = validate_files(result, measured, None, "right", "1,-1")
    assert stated.validation.compared.all()
    assert stated.validation.models[0].comparison.max_um < 1e-3
    assert not any("--start-direction" in text for text in stated.remarks)


def test_other_nominal_links_are_refused(tmp_path: Path) -> None:
    other = {**bare(), "nominal": {"link1_mm": 330.0, "link2_mm": 220.0}}
    with pytest.raises(UsageError, match="identified with other nominal links"):
        validate_files(
            stored(tmp_path, bare()),
            joint_file(tmp_path, way()),
            stored(tmp_path, other, "other.json"),
            "right",
            "1,1",
        )


def test_results_of_one_kind_are_called_by_their_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = facts(
        capsys,
        stored(tmp_path, bare(), "new.json"),
        joint_file(tmp_path, way()),
        stored(tmp_path, bare(), "old.json"),
    )
    assert [model["title"] for model in found["models"]] == ["old", "new"]


def test_crosstalk_of_a_result_is_part_of_the_prediction(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # What J2 adds to J1 is 15 mdeg × cos θ2; J1 has periodic errors of its own.
    common = {"target": "theta1", "unit": "mdeg", "u": 0.1}
    term = {**common, "source": "theta2", "part": "cos", "order": 1, "value": 15.0}
    own = {**common, "source": "theta1", "part": "sin", "order": 9, "value": 2.0}
    lines = [JOINTS]
    for one, two, s1, s2 in way():
        first = (10.0 if s1 > 0 else -10.0) + 20.0 * one / 90.0
        first += 15.0 * math.cos(math.radians(two)) + 2.0 * math.sin(9.0 * math.radians(one))
        x, y = in_frame(place(one + 1e-3 * first, two + 0.005 * s2, 325.1, 224.9))
        lines.append(f"{one},{two},{s1},{s2},{x:.9f},{y:.9f}")
    measured = text_file(tmp_path, "\n".join(lines) + "\n")
    found = facts(capsys, stored(tmp_path, {**bare(), "extension": [term, own]}), measured, None)
    assert found["models"][0]["rms_um"] < 1e-3
    quantities = {(one["joint"], one["symbol"]): one["value_mdeg"] for one in found["iso230_2"]}
    # Nodes 0° and 90°: +10, +30 and −10, +10 mdeg; at 90° the sine of 9 × 90° adds 2 mdeg to both directions.
    assert quantities[1, "B"] == pytest.approx(20.0)
    assert quantities[1, "B̄"] == pytest.approx(20.0)
    assert quantities[1, "E"] == pytest.approx(42.0)
    assert quantities[1, "E↑"] == pytest.approx(22.0)
    assert quantities[1, "M"] == pytest.approx(22.0)
    assert quantities[2, "B"] == pytest.approx(10.0)
    assert quantities[2, "E↑"] == pytest.approx(0.0, abs=1e-9)


def test_repeated_passes_give_pose_repeatability(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    commands = way(6) * 4
    offsets = np.array([[6.0, 0.0], [-6.0, 0.0], [0.0, 6.0], [0.0, -6.0]]) * 1e-3
    noise = np.repeat(offsets, len(way(6)), axis=0)
    found = facts(capsys, stored(tmp_path, bare()), joint_file(tmp_path, commands, noise=noise), None)
    assert len(found["iso9283"]) == 12
    for pose in found["iso9283"]:
        # All four lie 6 µm from their barycentre, which is where the model puts it.
        assert pose["n"] == 4
        assert pose["rp_um"] == pytest.approx(6.0, abs=1e-3)
        assert pose["ap_to_model_um"] == pytest.approx(0.0, abs=1e-3)
        command: Command = (pose["theta1_deg"], pose["theta2_deg"], pose["direction1"], pose["direction2"])
        off = math.dist(true_place(command), place(*command[:2], *NOMINAL))
        assert pose["ap_um"] == pytest.approx(1e3 * off, abs=1e-2)


def test_the_page_holds_figures_tables_and_what_was_left_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 49)
    both = np.concatenate([angle, angle[::-1]])
    lines = ["x_mm,y_mm,x_meas_mm,y_meas_mm,u_mm"]
    for a in both:
        x, y = 170.0 + 50.0 * math.cos(a), 330.0 + 50.0 * math.sin(a)
        lines.append(f"{x:.6f},{y:.6f},{x + 0.004 * math.cos(2 * a):.6f},{y:.6f},0.01")
    page = tmp_path / "validation.html"
    validate_path(
        Wanted(
            stored(tmp_path, bare()),
            text_file(tmp_path, "\n".join(lines) + "\n"),
            stored(tmp_path, bare("conventional"), "conventional.json"),
            page,
            start_direction="-1,1",
        ),
        None,
    )
    out = capsys.readouterr()
    assert "rms 2D µm" in out.out
    assert "J1: quantities of ISO 230-2 from the map" in out.out
    found = read_page(page.read_text(encoding="utf-8"))
    assert {"figure-path-x", "figure-path-y", "figure-trajectories"} <= set(found.all_of("id"))
    assert "Circular test, quantities of ISO 230-4" in found.text
    assert "no direction of approach holds" in found.text
    assert "Validation on path.csv" in found.text


def test_the_way_turns_where_the_path_turns_back() -> None:
    line = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 0.0], [1.0, 0.0], [0.0, 0.0], [0.0, 1.0]])
    assert travel_of(line).tolist() == [1, 1, 1, 1, -1, -1, -1]
    angle = np.linspace(0.0, 2.0 * np.pi, 37)
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    assert travel_of(np.vstack([circle, circle[::-1]])).tolist() == [1] * 38 + [-1] * 36


def test_rows_along_the_path(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Measured is the true place minus the command by hand; what each model leaves has the rms reported for it."""
    measured = joint_file(tmp_path, way())
    nominal = {**bare("conventional"), "link1_mm": {"value": 325.0, "u": 0.0}}
    nominal |= {"link2_mm": {"value": 225.0, "u": 0.0}, "theta20_mdeg": {"value": 0.0, "u": 0.0}}
    found = facts(capsys, stored(tmp_path, bare()), measured, stored(tmp_path, nominal, "nominal.json"))
    path = found["path"]
    assert path["line"] == list(range(2, 26))
    # The row at the turn is where the way there ended.
    assert path["way_there"][:12] == [True] * 12
    assert path["way_there"][13:] == [False] * 11
    both = {each["symbol"]: each for each in path["deviations"]}
    for component, symbol in enumerate(("E_X", "E_Y")):
        by_hand = [
            1e3 * (true_place(one)[component] - place(one[0], one[1], *NOMINAL)[component]) for one in way()
        ]
        np.testing.assert_allclose(both[symbol]["measured_um"], by_hand, atol=1e-2)
        np.testing.assert_allclose(both[symbol]["predicted_um"][1], by_hand, atol=1e-2)
        left = np.subtract(both[symbol]["measured_um"], both[symbol]["predicted_um"][0])
        assert np.sqrt(np.mean(left**2)) == pytest.approx(found["models"][0][f"rms_{'xy'[component]}_um"])

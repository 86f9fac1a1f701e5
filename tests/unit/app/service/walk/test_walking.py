"""Walking a plan, and what a real arm may drive afterwards."""

from dataclasses import replace
from pathlib import Path

import pytest

from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.engine.questions import WALK_WAIVER
from catseye.app.engine.walked.register import WALK, geometry_digest, own_legs, walked_legs
from catseye.app.engine.walked.rule import WAIVER
from catseye.app.exitcode import ExitCode
from catseye.app.render.page import write_page
from catseye.app.results.scara.run_report import run_report
from catseye.app.service.walk.walk import WalkedOverride
from catseye.app.store.reader import RunReader
from catseye.app.store.verify import verify
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.errors import LinkError
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.records import Row
from tests.unit.app.engine.walked.tours import ELSEWHERE, FIRST, SECOND, Tour, TourBench

REASON = "short visit, arm watched at the pendant"


@pytest.fixture
def bench(tmp_path: Path) -> TourBench:
    return TourBench(tmp_path)


@pytest.fixture
def real(bench: TourBench) -> TourBench:
    bench.fakes.make_real()
    return bench


async def test_a_walk_is_a_sealed_run_whose_steps_are_motions(bench: TourBench) -> None:
    outcome = await bench.walk()
    reader = RunReader(outcome.path)
    assert (outcome.status, verify(outcome.path).ok) == ("complete", True)
    assert reader.meta["procedure"] == "walk"
    assert reader.meta["walk"] == {
        "procedure": "tour",
        "geometry_sha256": geometry_digest(bench.planned().loaded.cell),
    }
    # The way back, with which the tour would begin again, lies in the tube of the way there.
    assert [(leg.start, leg.end) for leg in own_legs(outcome.path)] == [(FIRST, FIRST), (FIRST, SECOND)]
    assert reader.rows("points") == []


class Round(Tour):
    """Goes through its places without standing still where the arm can do that."""

    async def _go(self, ctx: Context, place: Pose) -> Row:
        one, *others = place
        await ctx.follow(((one + 2.0, *others), (one - 2.0, *others)))
        return {}


async def test_corners_wider_than_a_tube_cannot_be_walked(tmp_path: Path) -> None:
    link = 'driver = "melfa-datalink"\ndatalink_endpoint = "tcp://127.0.0.1:10003"'
    blended = TEMPLATE.replace('driver = "melfa-r3"', link, 1)
    outcome = await TourBench(tmp_path, Round((FIRST,)), blended).walk()
    assert (outcome.status, outcome.exit_code) == ("failed", ExitCode.REJECTED)
    assert "the arm cuts the corners on its way to" in outcome.text
    assert (await TourBench(tmp_path, Round((FIRST,))).walk()).status == "complete"


async def test_a_walk_is_driven_slowly(bench: TourBench) -> None:
    bench.fakes.robot.state = replace(bench.fakes.robot.state, override_percent=100.0)
    await bench.walk()
    calls = bench.fakes.robot.calls
    overrides = [
        float(call.split()[1]) for call in calls[: calls.index("move")] if call.startswith("override")
    ]
    assert overrides[0] == 10.0
    assert overrides == sorted(overrides, reverse=True)
    assert 1.0 <= overrides[-1] <= 10.0
    # What stood there before, not what a first lowering has left.
    assert bench.walked.override == WalkedOverride(100.0, overrides[-1], overrides[-1])


async def test_an_override_that_does_not_come_down_moves_nothing(bench: TourBench) -> None:
    bench.fakes.robot.overrides = [20.0]
    outcome = await bench.walk()
    assert outcome.exit_code == ExitCode.SAFETY
    assert bench.moves == 0


async def test_too_fast_an_arm_is_not_walked(bench: TourBench) -> None:
    bench.cell_text = bench.cell_text.replace(
        "[robot]\n", "[robot]\nspeed_deg_s = [42000.0, 7200.0, 30000.0]\n", 1
    )
    outcome = await bench.walk()
    assert outcome.exit_code == ExitCode.SAFETY
    assert "cannot be walked" in outcome.text
    assert bench.moves == 0


async def test_what_was_walked_is_not_walked_again(bench: TourBench) -> None:
    await bench.walk()
    outcome = await bench.walk()
    assert outcome.status == "complete"
    assert bench.moves == 0


async def test_an_emulated_arm_needs_no_walk(bench: TourBench) -> None:
    outcome = await bench.run()
    assert outcome.status == "complete"
    assert not bench.asked


async def test_a_real_arm_that_was_not_walked_is_not_moved(real: TourBench) -> None:
    outcome = await real.run()
    assert outcome.exit_code == ExitCode.SAFETY
    assert "2 of 2 motions of this run were not walked" in outcome.text
    assert "--walk" in outcome.text
    assert not {"move", "servo on"} & set(real.fakes.robot.calls)
    event = next(e for e in RunReader(outcome.path).events() if e.kind == "walked-motions")
    assert event.data["unwalked"] == 2
    assert event.data["first"] == [
        {"from": list(FIRST), "to": list(FIRST)},
        {"from": list(FIRST), "to": list(SECOND)},
    ]


async def test_a_real_arm_that_was_walked_runs_unasked(real: TourBench) -> None:
    assert (await real.walk()).status == "complete"
    outcome = await real.run()
    assert (outcome.status, real.asked) == ("complete", [])
    assert WAIVER not in RunReader(outcome.path).meta


async def test_a_waiver_is_kept_with_the_run(real: TourBench) -> None:
    outcome = await real.run(waive_walk=REASON)
    assert (outcome.status, real.asked, real.moves) == ("complete", [], 2)
    kept = RunReader(outcome.path).meta[WAIVER]
    assert isinstance(kept, dict)
    assert kept["reason"] == REASON
    assert [e.data["reason"] for e in RunReader(outcome.path).events() if e.kind == "walk-waived"] == [REASON]


async def test_a_report_states_the_waiver(real: TourBench, tmp_path: Path) -> None:
    outcome = await real.run(waive_walk=REASON)
    write_page(run_report(RunReader(outcome.path), real.root), tmp_path / "report.html")
    assert REASON in (tmp_path / "report.html").read_text(encoding="utf-8")


async def test_a_person_may_type_the_waiver(real: TourBench) -> None:
    real.answer = REASON
    outcome = await real.run()
    assert outcome.status == "complete"
    assert [(each.id, each.kind, each.motion) for each in real.asked] == [(WALK_WAIVER.id, "text", True)]
    assert REASON in str(RunReader(outcome.path).meta[WAIVER])


@pytest.mark.parametrize("answer", ["no", " No ", ""])
async def test_no_is_no_waiver(real: TourBench, answer: str) -> None:
    real.answer = answer
    outcome = await real.run()
    assert (outcome.exit_code, real.moves) == (ExitCode.SAFETY, 0)
    assert WAIVER not in RunReader(outcome.path).meta


async def test_an_empty_waiver_is_none(real: TourBench) -> None:
    outcome = await real.run(waive_walk="  ")
    assert (outcome.exit_code, real.moves) == (ExitCode.SAFETY, 0)


async def test_an_unplanned_motion_is_refused_at_the_gate(real: TourBench) -> None:
    real.tour = Tour(surprise=ELSEWHERE)
    await real.walk()
    outcome = await real.run()
    assert outcome.exit_code == ExitCode.SAFETY
    assert "was not walked" in outcome.text
    assert real.moves == 2
    assert real.fakes.robot.pose == SECOND


async def test_a_motion_that_no_plan_foresaw_may_be_waived(real: TourBench) -> None:
    real.tour = Tour(surprise=ELSEWHERE)
    await real.walk()
    real.answer = REASON
    outcome = await real.run()
    assert outcome.status == "complete"
    assert len(real.asked) == 1
    assert real.fakes.robot.pose == ELSEWHERE


async def test_an_emulated_walk_says_nothing_about_a_real_arm(bench: TourBench) -> None:
    await bench.walk()
    bench.fakes.make_real()
    assert (await bench.run()).exit_code == ExitCode.SAFETY


async def test_a_walk_of_another_arm_does_not_count(bench: TourBench) -> None:
    await bench.walk()
    cell = bench.planned().loaded.cell
    assert len(walked_legs(bench.root, cell, Identity("fake", "2.0", "7", True))) == 2
    for other in (Identity("fake", "1.0", "8", True), Identity("other", "1.0", "7", True)):
        assert walked_legs(bench.root, cell, other) == []


async def test_arms_without_serial_numbers_are_distinguished_by_endpoint(
    real: TourBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    nameless = Identity("fake", "1.0", "", False)

    async def connect() -> Identity:
        return nameless

    monkeypatch.setattr(real.fakes.robot, "connect", connect)
    await real.walk()
    assert len(walked_legs(real.root, real.planned().loaded.cell, nameless)) == 2
    real.cell_text = real.cell_text.replace("tcp://127.0.0.1:10001", "tcp://127.0.0.1:10009")
    assert walked_legs(real.root, real.planned().loaded.cell, nameless) == []


@pytest.mark.parametrize(
    ("old", "new", "holds"),
    [
        ("link2_mm = 225.0", "link2_mm = 226.0", False),
        ("j1 = [-170.0, 170.0]", "j1 = [-160.0, 170.0]", False),
        ("x_mm = 650.0", "x_mm = 600.0", False),
        ("column_radius_mm = 110.0", "column_radius_mm = 120.0", False),
        ("settle_time_s = 0.5", "settle_time_s = 0.7", True),
        ("tcp://127.0.0.1:10001", "tcp://127.0.0.1:10009", True),
        ("override_cap_percent = 20", "override_cap_percent = 15", True),
    ],
)
async def test_a_walk_holds_while_the_geometry_does(
    bench: TourBench, old: str, new: str, *, holds: bool
) -> None:
    await bench.walk()
    assert old in bench.cell_text
    bench.cell_text = bench.cell_text.replace(old, new)
    found = walked_legs(bench.root, bench.planned().loaded.cell, Identity("fake", "1.0", "7", True))
    assert bool(found) is holds


async def test_a_walk_that_was_changed_does_not_count(bench: TourBench) -> None:
    outcome = await bench.walk()
    log = outcome.path / "wire.log"
    log.chmod(0o600)
    log.write_text("nothing happened\n")
    cell = bench.planned().loaded.cell
    assert walked_legs(bench.root, cell, Identity("fake", "1.0", "7", True)) == []


async def test_an_unsealed_walk_does_not_count(bench: TourBench) -> None:
    outcome = await bench.walk()
    outcome.path.chmod(0o700)
    (outcome.path / "manifest.json").unlink()
    cell = bench.planned().loaded.cell
    assert walked_legs(bench.root, cell, Identity("fake", "1.0", "7", True)) == []


async def test_a_walk_that_cannot_be_read_hides_no_other(bench: TourBench) -> None:
    await bench.walk()
    unreadable = bench.root / f"20200101T000000Z_{WALK}_abcdef"
    unreadable.mkdir()
    (unreadable / "run.sqlite").symlink_to("n" * 300)
    cell = bench.planned().loaded.cell
    assert len(walked_legs(bench.root, cell, Identity("fake", "1.0", "7", True))) == 2


async def test_half_a_walk_counts_for_what_was_driven(bench: TourBench) -> None:
    robot, move = bench.fakes.robot, bench.fakes.robot.move_joints

    async def breaks(target: Pose) -> None:
        if target == SECOND:
            raise LinkError("tcp://robot is silent")
        await move(target)

    robot.move_joints = breaks  # type: ignore[method-assign]  # a link that breaks on the second motion
    broken = await bench.walk()
    assert broken.status == "failed"
    cell = bench.planned().loaded.cell
    found = walked_legs(bench.root, cell, Identity("fake", "1.0", "7", True))
    assert [leg.end for leg in found] == [FIRST]


async def test_a_walk_goes_on_where_it_was_interrupted(bench: TourBench) -> None:
    robot, move = bench.fakes.robot, bench.fakes.robot.move_joints

    async def breaks(_target: Pose) -> None:
        robot.move_joints = move  # type: ignore[method-assign]  # the next motion is sound
        raise LinkError("tcp://robot is silent")

    robot.move_joints = breaks  # type: ignore[method-assign, assignment]  # a link that breaks once
    broken = await bench.walk()
    assert broken.status == "failed"
    outcome = await bench.walk(resume=broken.path)
    assert (outcome.status, outcome.path) == ("complete", broken.path)
    assert {leg.end for leg in own_legs(outcome.path)} == {FIRST, SECOND}


async def test_a_real_arm_is_not_walked_by_itself(real: TourBench) -> None:
    outcome = await real.walk(by_itself=True)
    assert outcome.exit_code == ExitCode.USAGE
    assert "while somebody holds a key" in outcome.text
    assert real.moves == 0

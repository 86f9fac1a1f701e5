"""What is stale looks stale: without a beam no green and no white value, and a dead link is red in every column."""

from typing import Any

import pytest
from textual.content import Content

from catseye.app.tui.bench_text import air_lines, beam_lines, device_line, robot_lines
from catseye.app.tui.widgets.static_text import lines
from catseye.app.tui.widgets.strip import Strip
from tests.unit.app.tui.scripted import ScriptedLink, shown, started
from tests.unit.app.tui.scripted_bench import BENCH, bench, bench_status, publish_strip
from tests.unit.app.tui.serial.scripted_arm import arm_bench


def with_dead(name: str, status: dict[str, Any] = BENCH) -> dict[str, Any]:
    """Return a bench one of whose links has just died."""
    devices = [
        {**device, "link": "lost", "error": "no answer"} if device["name"] == name else device
        for device in status["devices"]
    ]
    return {**status, "devices": devices}


def styles_of(text: Content) -> set[str]:
    return {str(span.style) for span in text.spans}


def plain_parts(text: Content) -> str:
    """Return what of a text has no style at all, blanks left out."""
    styled = {at for span in text.spans if span.style for at in range(span.start, span.end)}
    return "".join(sign for at, sign in enumerate(text.plain) if at not in styled and not sign.isspace())


@pytest.mark.parametrize("status", [BENCH, arm_bench()], ids=["scara", "serial arm"])
def test_a_dead_link_is_red_in_every_column(status: dict[str, Any]) -> None:
    found = bench_status(**with_dead("robot", status)).device("robot")
    assert found is not None
    line = device_line(found, 0.0)
    assert styles_of(line) == {"$error bold"}
    assert plain_parts(line) == ""


def test_values_of_a_dead_link_are_red_at_once() -> None:
    for name, text in (
        ("robot", lines(*robot_lines(bench_status(**with_dead("robot")), 0.0, roomy=False))),
        ("interferometer", lines(*beam_lines(bench_status(**with_dead("interferometer")), 0.0))),
    ):
        assert "link lost" in text.plain, name
        assert not plain_parts(text), name
        assert not any("success" in style for style in styles_of(text)), name
    air = air_lines(bench_status(**with_dead("environment")), 0.0)[0]
    assert styles_of(air) == {"$error"}


def test_a_dead_interferometer_promises_no_beam() -> None:
    text = lines(*beam_lines(bench_status(**with_dead("interferometer")), 0.0)).plain
    assert "BEAM OK" not in text
    assert "✗ NO LINK (link lost)" in text


def test_without_a_beam_the_count_is_not_white() -> None:
    text = beam_lines(bench_status(beam={"beam_ok": False}), 0.0)[2]
    assert "743.123 456 mm" in text.plain
    assert styles_of(text) == {"dim"}
    assert styles_of(beam_lines(bench_status(), 0.0)[2]) <= {""}


@pytest.mark.parametrize(
    ("status", "green"),
    [
        (BENCH, True),
        (bench(beam={"beam_ok": False}), False),
        (with_dead("interferometer"), False),
    ],
    ids=["well", "no beam", "no link"],
)
async def test_no_beam_means_no_green_strip(status: dict[str, Any], green: bool) -> None:
    async with started(size=(120, 40)) as (app, pilot, link):
        link.publish("bench", **status)
        publish_strip(link)
        await shown(app, pilot)
        assert ("$success" in styles_of(app.screen.query_one(Strip).shown)) is green


async def test_the_second_line_shows_a_dead_link_on_every_screen() -> None:
    async with started() as (app, pilot, link):
        publish(link, with_dead("interferometer"))
        assert "NO LINK" in (await shown(app, pilot)).splitlines()[1]
        publish(link, with_dead("robot"))
        assert "servo off 10 % (link lost)" in (await shown(app, pilot)).splitlines()[1]


def publish(link: ScriptedLink, status: dict[str, Any]) -> None:
    link.publish("bench", **status)

"""The verdict of a job for people."""

from typing import Final

from catseye.app.protocol.campaign_events import CampaignEnded, StageVerdict, Verdict
from catseye.app.results.model import Column, Report, Sign, Statement, Table, section
from catseye.app.results.origin import origin_now

_SIGNS: Final[dict[Verdict, Sign]] = {"passed": Sign.GOOD, "failed": Sign.BAD, "not-done": Sign.ATTENTION}
_WORDS: Final[dict[Verdict, str]] = {"passed": "passed", "failed": "failed", "not-done": "not done"}


def campaign_report(verdict: CampaignEnded) -> Report:
    """Return a table of the stages, and the verdict in a sentence."""
    columns = (
        Column("stage", "stage"),
        Column("verdict", "verdict"),
        Column("code", "why"),
        Column("text", "text"),
        Column("run", "run"),
    )
    table = Table("stages", "Stages", columns, tuple(map(_row, verdict.stages)))
    said = Statement(_SIGNS[verdict.verdict], f"job {verdict.job} {_WORDS[verdict.verdict]}: {verdict.text}")
    return Report(
        f"Job {verdict.job}", origin_now(), (section("verdict", "Verdict", [said, table], brief=True),)
    )


def _row(one: StageVerdict) -> tuple[str, str, str, str, str]:
    run = one.runs[-1].rpartition("_")[2] if one.runs else ""
    return (one.stage, _WORDS[one.verdict], one.code, one.text, run)

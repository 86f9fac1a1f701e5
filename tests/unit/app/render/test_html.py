"""Reports as pages."""

from dataclasses import replace

from catseye.app.cluster.processes import processes
from catseye.app.render.page import page_html
from catseye.app.results.model import Section, Sign, Statement
from tests.unit.app.render.page_reader import read_page
from tests.unit.app.render.reports import FIGURE, REPORT, TABLE

REPORT_FIGURE = replace(FIGURE, key="others", caption="Another.")


def test_every_block_stands_on_the_page() -> None:
    html = page_html(REPORT)
    page = read_page(html)
    assert page.headings == ["Verdict", "Values", "More"]
    assert page.rows[0] == ["quantity", "unit", "value / mm", "rows"]
    assert page.row("L1") == ["mm", "−1.2346", "3"]
    assert ("figure", "id", "figure-marks") in page.attributes
    assert '<span class="default">a = 1</span>\nb &lt; 2' in html
    for text in ("Text & text", "Left out", "What marks look like.", "Only on the page."):
        assert text in page.text


def test_figures_drawn_by_other_processes_are_the_same() -> None:
    with processes(2) as share:
        assert page_html(REPORT, share) == page_html(REPORT)


def test_statements_carry_their_sign_as_a_class() -> None:
    html = page_html(REPORT)
    for sign, glyph in (("good", "✓"), ("bad", "✗"), ("attention", "!"), ("neutral", "·")):
        assert f'<li class="{sign}"><span class="sign">{glyph}</span>' in html


def test_figures_and_tables_are_numbered_through_the_page() -> None:
    twice = replace(REPORT, sections=(*REPORT.sections, Section("again", "Again", (TABLE, REPORT_FIGURE))))
    page = read_page(page_html(twice))
    for caption in (
        "Table 1. Values",
        "Table 2. Values",
        "Figure 1. What marks look like.",
        "Figure 2. Another.",
    ):
        assert caption in page.text
    names = page.all_of("id")
    assert names.count("table-values") == 1
    assert len(names) == len(set(names))


def test_a_sentence_links_to_what_shows_it() -> None:
    said = Statement(Sign.GOOD, "It holds.", see=("table-values", "figure-marks", "figure-absent"))
    first = Section("first", "First", (said,))
    html = page_html(replace(REPORT, sections=(first, *REPORT.sections)))
    assert 'It holds. (<a href="#table-values">Table 1</a>, <a href="#figure-marks">Figure 1</a>)' in html


def test_captions_of_tables_stay_still_while_the_table_scrolls() -> None:
    html = page_html(REPORT)
    caption = '<p class="caption" id="table-values-caption"><b>Table 1.</b> Values</p>'
    assert f'{caption}<div class="scroll" tabindex="0" role="region" aria-label="Table 1"><table' in html


def test_moments_are_readable() -> None:
    assert "2026-01-02 03:04:05 UTC · catseye 0.1.0" in read_page(page_html(REPORT)).text

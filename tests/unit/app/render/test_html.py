"""Reports as pages."""

from catseye.app.cluster.processes import processes
from catseye.app.render.page import page_html
from tests.unit.app.render.page_reader import read_page
from tests.unit.app.render.reports import REPORT


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

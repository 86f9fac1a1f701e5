"""The glossary: its terms, and the page that is written from them."""

import os
import re
from pathlib import Path

from catseye.app.results.glossary import GLOSSARY, glossary_markdown

PAGE = Path(__file__).parents[4] / "docs" / "glossary.md"
PART = re.compile(r"(<!-- glossary: [^>]*-->\n).*?(<!-- end of glossary -->)", re.DOTALL)
ON_SCREENS = (
    "innovation take-up Eq. 2 E_YY map closure open loop dead path nest U u k = 2 AP RP E_s reversal LOWESS gauge "
    "residual segment pitch drift outlier plateau override node θ20 θ40"
)


def test_the_page_is_written_from_the_glossary() -> None:
    """CATSEYE_RENEW_SCREENS=1 writes the table anew."""
    text, table = PAGE.read_text(encoding="utf-8"), f"{glossary_markdown()}\n"
    if os.environ.get("CATSEYE_RENEW_SCREENS"):
        text = PART.sub(lambda found: f"{found[1]}{table}{found[2]}", text)
        PAGE.write_text(text, encoding="utf-8")
    found = PART.search(text)
    assert found is not None
    assert table in found[0]


def test_terms_of_the_screens_are_explained() -> None:
    names = {name.strip() for term in GLOSSARY for name in term.name.split(",")}
    wanted = {"k = 2", "Eq. 2", "open loop", "dead path", "least increment step"}
    wanted |= set(re.sub(r"k = 2|Eq\. 2|open loop|dead path", "", ON_SCREENS).split())
    assert wanted - names == set()


def test_each_term_is_explained_once() -> None:
    names = [name.strip() for term in GLOSSARY for name in term.name.split(",")]
    assert len(names) == len(set(names))
    assert all(term.text.endswith(".") for term in GLOSSARY)

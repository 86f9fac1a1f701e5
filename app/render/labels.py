"""Names of the figures and tables of a page: Figure 3, Table 5, and the anchors that links lead to."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from catseye.app.results.figures import Figure
from catseye.app.results.model import Block, Table


@dataclass(frozen=True)
class Label:
    """Name of a figure or table on its page.

    Attributes:
        text: kind and number.
        anchor: name of the element.
    """

    text: str
    anchor: str


class Labels:
    """Labels of all figures and tables of a page, each kind numbered through in reading order."""

    def __init__(self, blocks: Iterable[Block]) -> None:
        counts: Counter[str] = Counter()
        self._by_key: dict[str, Label] = {}
        labels: list[Label] = []
        for block in blocks:
            if not isinstance(block, Figure | Table):
                continue
            kind = "figure" if isinstance(block, Figure) else "table"
            counts[kind] += 1
            key = f"{kind}-{block.key}"
            # A page of several stages may have a table twice: a link leads to the first one.
            anchor = f"{key}-{counts[kind]}" if key in self._by_key else key
            labels.append(Label(f"{kind.capitalize()} {counts[kind]}", anchor))
            self._by_key.setdefault(key, labels[-1])
        self._in_order = iter(labels)

    def next(self) -> Label:
        """Return the label of the next figure or table."""
        return next(self._in_order)

    def find(self, keys: Iterable[str]) -> list[Label]:
        """Return the labels of those figures and tables that the page has, by `figure-KEY` or `table-KEY`."""
        return [self._by_key[key] for key in keys if key in self._by_key]

"""What there is to say about the error budget that a result stands on."""

import math

from catseye.app.cell.scara.uncertainty import ContributorEntry
from catseye.app.results.model import Sign, Statement
from catseye.app.results.numbers import counted, fixed, number
from catseye.app.results.scara.budget_part import BudgetPart


def budget_statements(part: BudgetPart) -> list[Statement]:
    """Return whose budget the uncertainties stand on, and what it leaves open."""
    texts = []
    if part.source != "none":
        whose = {"run": "the run", "table": "the table", "cell": "the cell file"}[part.source]
        size = counted(len(part.contributor), "contributor")
        texts.append(f"Error budget: that of {whose} {part.name}, {size}.")
        if part.sigma_mm == "white":
            texts.append(
                "The column sigma_mm is what differs from distance to distance; the budget adds what several "
                "distances share."
            )
    texts += [_learnt_text(entry) for entry in part.contributor if entry.spectrum]
    return [
        *(Statement(Sign.NEUTRAL, text) for text in texts),
        *(Statement(Sign.ATTENTION, f"{text[0].upper()}{text[1:]}.") for text in budget_remarks(part)),
    ]


def _learnt_text(entry: ContributorEntry) -> str:
    """Return how large the distances show an error whose size was stated or assumed."""
    shares = entry.contributor().shares if entry.correlation == "time" else entry.spectrum
    mean = sum(shares) if entry.correlation == "time" else sum(shares) / len(shares)
    whose = "assumed" if entry.assumed else "stated"
    size = f"{number(math.sqrt(mean), fixed(1))} times the {whose} {entry.stated}"
    listed = ", ".join(number(math.sqrt(ratio), fixed(1)) for ratio in entry.spectrum)
    several = entry.correlation != "time" and len(entry.spectrum) > 1
    orders = f" (orders 1 to {len(entry.spectrum)}: {listed})" if several else ""
    return f"{entry.name}: the distances suggest {size}{orders}."


def budget_remarks(part: BudgetPart) -> list[str]:
    """Return what a reader of a result has to know about its uncertainties."""
    remarks = []
    if part.source == "none":
        white = "sigma_mm" if part.sigma_mm == "white" else "the scatter of the fit"
        remarks.append(
            f"no error budget was used: {white} counts as white noise, and what several distances share (scale, "
            "error motions of the axes) is missing in every u"
        )
    if part.sigma_mm == "total":
        remarks.append(
            "the column sigma_mm holds all contributors of the budget, as earlier versions exported it: the budget "
            "counts, and sigma_mm not beside it"
        )
    if part.corrected_by is None:
        remarks.append(
            "nothing says whether the distances are corrected for the air; if not, all lengths are 270 ppm too "
            "large, a link of 325 mm by 0.09 mm: the scale is not assured"
        )
    return remarks

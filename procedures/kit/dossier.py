"""The last stage of every way: its day on one page, with a certificate."""

from typing import Final

from catseye.procedures.kit.procedure import Analysis, Stage

DOSSIER: Final = "dossier"
"""The command that makes it."""


def dossier(order: int, way: str) -> Analysis:
    """Return the stage that joins a way.

    Args:
        order: its place, after all others of the way.
    """
    return Analysis(
        DOSSIER,
        gives="",
        stage=Stage(order, "the whole day on one page, beginning with a certificate", way),
        writes_result=False,
        usage=("{cell}", "{runs}", "-o", "{folder}dossier-{name}.html"),
        writes="dossier-{name}.html",
        joins=True,
    )

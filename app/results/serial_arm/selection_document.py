"""What a choice of poses came to, as `catseye select-poses --json` writes it, and its figure."""

from typing import TYPE_CHECKING, Final

from pydantic import BaseModel

from catseye.app.results.numbers import counted

if TYPE_CHECKING:
    # Mathematics are imported with the first figure, not with the first screen.
    from catseye.app.results.figures import Figure

ADVICE: Final = (
    "Drive to each pose from lower joints, as the choice assumes, and measure the targets that it names."
)


class IndexOfCount(BaseModel):
    """The index that a number of poses reaches."""

    count: int
    value: float


class SelectionDocument(BaseModel):
    """A choice of poses.

    Attributes:
        output: the poses CSV; empty before it is written.
        index: observability index that was raised.
        value: that the choice reaches.
        count: of poses.
        measurements: of targets at them.
        candidates: that the poses were chosen from.
        drawn: random poses, of which the candidates keep the rules.
        exchanges: of the best start, after which no other one raised the index.
        starts: of the search, the best of which was taken.
        model: whose parameters the poses are to show.
        parameters: that they show.
        index_of_count: what other numbers of poses reach, one start each.
    """

    output: str = ""
    index: str
    value: float
    count: int
    measurements: int
    candidates: int
    drawn: int
    exchanges: int
    starts: int
    model: str
    parameters: tuple[str, ...]
    index_of_count: tuple[IndexOfCount, ...]

    @property
    def text(self) -> str:
        """What was chosen, in a sentence."""
        several = (
            "" if self.measurements == self.count else f" with {self.measurements} measurements of targets"
        )
        return (
            f"{self.count} poses{several} of {self.candidates} candidates, {self.index} {self.value:.4g} after "
            f"{self.exchanges} exchanges in the best of {counted(self.starts, 'start')}; they show "
            f"{len(self.parameters)} parameters of the model {self.model}."
        )

    def figure(self) -> "Figure":
        """Return the index against the number of poses."""
        import numpy as np

        from catseye.app.results.figures import Axis, Figure, Level, Panel, Points, Role

        counts = np.array([float(one.count) for one in self.index_of_count])
        values = np.array([one.value for one in self.index_of_count])
        marks = (
            Points(counts, values, Role.CHOSEN, self.index, joined=True),
            Level(
                float(self.count),
                Role.COMMAND,
                vertical=True,
                dash="dashed",
                label=f"the {self.count} poses chosen",
            ),
        )
        panel = Panel("", Axis("number of poses"), Axis(f"index {self.index}"), marks)
        caption = "The index against the number of poses, one start each."
        return Figure("growth", "Index against the number of poses", caption, ((panel,),))

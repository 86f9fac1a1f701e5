"""Trajectories with magnified errors, as part of a report."""

from catseye.app.render.drawing import figure
from catseye.app.render.markup import Html
from catseye.app.results.scara.figures.trajectories import magnification, trajectory_figure
from catseye.app.results.scara.validation import PathValidation


def trajectory_section(validation: PathValidation) -> Html:
    """Return the figure of measured and predicted trajectories, side by side.

    Args:
        validation: models on the path, the best one last.
    """
    factor = magnification(validation)
    return figure(
        trajectory_figure(validation),
        "trajectories",
        "Trajectories with magnified errors",
        f"Grey line and black dots: command positions; from there the error, magnified {factor:g} times (the bar "
        "tells its scale), to where the arm was measured or is predicted. The last panel, measured minus the best "
        "model, is what a compensation with that model would leave.",
    )

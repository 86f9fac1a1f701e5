"""Arguments and options of commands about paths of a SCARA, each declared once."""

from typing import Annotated, Literal

import typer

HandName = Literal["right", "left"]

Hand = Annotated[HandName, typer.Option(help="elbow for Cartesian positions; right: theta2 >= 0")]
StartDirection = Annotated[
    str,
    typer.Option(
        metavar="S1,S2|along",
        help="directions of approach of J1 and J2 at the first Cartesian row of each line, 1 or -1; along: that of "
        "the line's first motion",
    ),
]
FlangeAngle = Annotated[float, typer.Option("--j4", metavar="DEG", help="angle of J4 along the whole path")]

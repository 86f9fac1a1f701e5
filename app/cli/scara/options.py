"""Arguments and options of commands about paths of a SCARA, each declared once."""

from typing import Annotated, Literal

import typer

HandName = Literal["right", "left"]

Hand = Annotated[HandName, typer.Option(help="of Cartesian positions: right has theta2 >= 0")]
StartDirection = Annotated[
    str,
    typer.Option(
        metavar="S1,S2|along",
        help="states of approach at the first Cartesian row of each line, 1 or -1 each; along enters each line in "
        "its own direction",
    ),
]
FlangeAngle = Annotated[float, typer.Option("--j4", metavar="DEG", help="angle of J4 all along the path")]

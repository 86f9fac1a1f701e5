"""One sign convention: reversal errors as ISO 230-2 has them, residuals measured minus predicted."""

import numpy as np
import pytest

from catseye.app.results.figures import Figure, Points, Role
from catseye.app.results.scara.figures.maps import map_figure
from catseye.app.results.scara.figures.residuals import residual_order_figure
from catseye.app.results.scara.fit_text import identified_text
from catseye.app.results.scara.residuals import pose_means
from catseye.app.results.scara.result import MapTable, Residuals
from catseye.app.results.serial_arm.validation import ArmValidation, Errors
from catseye.app.results.serial_arm.validation_document import arm_validation_document
from catseye.app.results.serial_arm.validation_report import arm_validation_report
from tests.unit.app.results.scara import sample

TOO_LONG = Residuals(
    reflector=["P1", "P1"],
    segment=[0, 0],
    theta1_deg=[0.0, 0.0],
    theta2_deg=[10.0, 10.0],
    direction1=[1, 1],
    direction2=[1, 1],
    residual_um=[3.0, 5.0],
)
"""The model predicts more than was measured."""


def points_of(figure: Figure, ink: Role | int) -> list[Points]:
    panels = [panel for row in figure.rows for panel in row if panel is not None]
    return [mark for one in panels for mark in one.marks if isinstance(mark, Points) and mark.ink == ink]


def test_reversal_error_is_the_upward_minus_the_downward_approach() -> None:
    # J1 comes to +2 mdeg from below and to −18 mdeg from above at both nodes: 20 mdeg.
    flat = MapTable(
        node_deg=[0.0, 90.0],
        positive_mdeg=[2.0, 2.0],
        negative_mdeg=[-18.0, -18.0],
        u_positive_mdeg=[1.0, 1.0],
        u_negative_mdeg=[1.0, 1.0],
    )
    result = sample.hand_made().model_copy(update={"theta1_map": flat, "theta2_map": flat})
    figure = map_figure(result)
    assert figure is not None
    assert [one.y.tolist() for one in points_of(figure, Role.REVERSAL)] == [[20.0, 20.0]] * 2
    assert "mean reversal error (+ minus −, ISO 230-2) of +20.0 mdeg" in identified_text(result)


def test_residuals_are_measured_minus_predicted() -> None:
    (dots,) = points_of(residual_order_figure(TOO_LONG), 0)
    assert dots.y.tolist() == [-3.0, -5.0]
    assert pose_means(TOO_LONG, "P1").mean_um.tolist() == [-4.0]


def test_length_errors_of_a_serial_arm_have_the_same_sign() -> None:
    found = ArmValidation(
        Errors(np.array([0.1, 0.3])), None, None, ("A", "B"), ("nest1", "nest1"), of_distances=True
    )
    report = arm_validation_report(found, "ballbar", sample.MADE)
    (row,) = report.table("by-target").rows
    assert row[3:] == pytest.approx((-0.2, 0.1, 0.3))
    (dots,) = points_of(report.figures("figures")[1], Role.POSITIVE)
    assert dots.y.tolist() == [-0.1, -0.3]
    assert arm_validation_document(found).by_target[0].mean_mm == pytest.approx(0.2)

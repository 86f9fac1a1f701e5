"""Optics against calculation by hand."""

import numpy as np
import pytest

from catseye.calibration.resolution.errors import RecordingError
from catseye.calibration.resolution.optics import AngleAccuracy, AngularOptics, LinearOptics


def test_five_degrees_come_back_to_the_last_digit() -> None:
    displacement = np.array([30.0 * 0.08715574274765817])
    assert AngularOptics(30.0).angle_rad(displacement)[0] == pytest.approx(np.deg2rad(5.0), rel=1e-14)


def test_the_small_angle_form_would_be_off_by_a_thousandth() -> None:
    displacement = np.array([30.0 * np.sin(np.deg2rad(5.0))])
    exact = AngularOptics(30.0).angle_rad(displacement)
    assert displacement[0] / 30.0 / exact[0] - 1.0 == pytest.approx(-0.00127, abs=1e-5)


def test_a_displacement_beyond_the_spacing_names_its_sample() -> None:
    with pytest.raises(RecordingError, match=r"sample 3: .*30.5 mm exceeds the spacing S = 30 mm") as refused:
        AngularOptics(30.0).angle_rad(np.array([0.0, 1.0, -30.5, 40.0]))
    assert refused.value.row == 3


def test_the_makers_accuracy_counts_as_twice_the_uncertainty() -> None:
    # 0.1° is 1745.33 µrad: 0.5 + 0.002 · 1745.33 + 0.1 · 0.5 = 4.04066 µrad for k = 2.
    assert AngularOptics(30.0).u_step(np.deg2rad(0.1)) == pytest.approx(2.02033e-6, rel=1e-5)


def test_the_spacing_adds_its_own_share() -> None:
    silent = AngularOptics(30.0, 0.03, 0.0, 0.0, 0.0, 0.0)
    assert silent.u_step(0.01) == pytest.approx(0.01 * 0.03 / 30.0)
    assert silent.u_scale == pytest.approx(0.001)


def test_angles_count_from_where_the_optics_are_parallel() -> None:
    angle_rad = np.deg2rad([5.0, 5.1, 6.0])
    displacement_mm = 30.0 * (np.sin(angle_rad) - np.sin(angle_rad[0]))
    stated = AngularOptics(30.0, zero_rad=float(angle_rad[0]))
    assert stated.angle_rad(displacement_mm) == pytest.approx(angle_rad, rel=1e-14)
    # Taken as parallel at 5°, a step there seems smaller by 1 − cos 5°.
    (first, second, _) = AngularOptics(30.0).angle_rad(displacement_mm)
    assert (second - first) / np.deg2rad(0.1) == pytest.approx(np.cos(np.deg2rad(5.05)), rel=1e-6)


@pytest.mark.parametrize(("turned_deg", "u_zero_deg"), [(0.0, 2.0), (1.5, 1.0), (5.0, 1.0), (-5.0, 3.0)])
def test_an_unknown_zero_is_in_u_as_draws_show(turned_deg: float, u_zero_deg: float) -> None:
    off_rad = np.deg2rad(u_zero_deg) * np.random.default_rng(5).standard_normal(200_000)
    # A tiny true step at the angle where the optics seem to stand, read as if the zero were known.
    true_rad = np.deg2rad(turned_deg) + off_rad
    seen = np.cos(true_rad) / np.cos(np.deg2rad(turned_deg))
    silent = AngularOptics(30.0, 0.0, 0.0, 0.0, 0.0, 0.0, u_zero_rad=float(np.deg2rad(u_zero_deg)))
    share = silent.over(np.deg2rad([0.0, turned_deg])).u_scale
    assert share == pytest.approx(float(np.sqrt(np.mean((seen - 1.0) ** 2))), rel=0.02)


def test_linear_optics_are_good_to_a_share_of_the_step() -> None:
    # 0.5 µm/m over 1 mm is 0.5 nm, for k = 2.
    assert LinearOptics().u_step(-1.0) == pytest.approx(0.25e-6)
    assert LinearOptics().u_scale == pytest.approx(0.25e-6)


def test_a_stated_accuracy_counts_as_twice_the_uncertainty() -> None:
    stated = AngleAccuracy(constant_urad=0.4, share=0.01)
    # 1 mrad: 0.4 µrad + 10 µrad, for k = 2.
    assert stated.u_step(-1e-3) == pytest.approx(5.2e-6)
    assert stated.u_scale == pytest.approx(0.005)

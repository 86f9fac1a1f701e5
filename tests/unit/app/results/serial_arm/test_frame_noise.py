"""The noise of fixed nests in the uncertainty of the base, against frames that are drawn."""

import numpy as np
import pytest

from catseye.app.results.serial_arm.frame_noise import with_frame_noise
from catseye.app.results.serial_arm.result import ParameterPart, SerialArmResult
from catseye.calibration.core.types import Floats
from catseye.procedures.serial_arm.nests import world_frame_covariance
from tests.unit.app.results.serial_arm.sample import sample_calibration

NESTS_MM = np.array([[2000.0, -500.0, 40.0], [2600.0, 300.0, 10.0], [1500.0, 500.0, -60.0]])
U_MM = np.array([[0.01, 0.03, 0.02], [0.04, 0.01, 0.03], [0.02, 0.02, 0.05]])
BASE_U = np.array([0.02, 0.02, 0.02, 0.001, 0.001, 0.001])
PARTS = ("x_mm", "y_mm", "z_mm", "rx_deg", "ry_deg", "rz_deg")
STANDS = np.array(
    [[0.8, -0.6, 0.0, 2100.0], [0.6, 0.8, 0.0, 150.0], [0.0, 0.0, 1.0, -300.0], [0.0, 0.0, 0.0, 1.0]]
)
"""The base in the frame of the instrument."""


def in_world(nests_mm: Floats) -> Floats:
    """Return place, mm, and angles of R = Rz·Ry·Rx, deg, of the base in the frame of three nests (Gram-Schmidt)."""
    origin, along, aside = nests_mm
    x = (along - origin) / np.linalg.norm(along - origin)
    y = (aside - origin) - ((aside - origin) @ x) * x
    y /= np.linalg.norm(y)
    axes = np.array([x, y, np.cross(x, y)])
    place, r = axes @ (STANDS[:3, 3] - origin), axes @ STANDS[:3, :3]
    angles = np.arctan2(r[2, 1], r[2, 2]), np.arcsin(-r[2, 0]), np.arctan2(r[1, 0], r[0, 0])
    return np.concatenate([place, np.rad2deg(angles)])


def result() -> SerialArmResult:
    base = [
        ParameterPart(
            name=f"base.{part}", value=value, u=u, unit=part[-3:].strip("_"), nominal=None, identified=True
        )
        for part, value, u in zip(PARTS, in_world(NESTS_MM).tolist(), BASE_U.tolist(), strict=True)
    ]
    (link,) = (one for one in sample_calibration().parameters if one.name == "J2.a_mm")
    return sample_calibration().model_copy(
        update={"parameters": [*base, link], "correlation": np.eye(7).tolist()}
    )


def test_base_is_as_uncertain_as_its_frame() -> None:
    rng = np.random.default_rng(6)
    covariance = np.array([np.diag(u**2) for u in U_MM])
    covariance[0, 0, 1] = covariance[0, 1, 0] = 0.8 * U_MM[0, 0] * U_MM[0, 1]
    roots = np.linalg.cholesky(covariance)
    drawn = np.array(
        [
            in_world(NESTS_MM + np.einsum("nij,nj->ni", roots, rng.standard_normal((3, 3))))
            for _ in range(20_000)
        ]
    )
    found = with_frame_noise(result(), world_frame_covariance(NESTS_MM, covariance))
    u = np.array([one.u for one in found.parameters])
    assert u[:6] == pytest.approx(np.sqrt(drawn.var(axis=0) + BASE_U**2), rel=0.03)
    assert u[6] == 0.012
    own = np.cov(drawn.T) + np.diag(BASE_U**2)
    correlation = own / np.sqrt(np.outer(np.diag(own), np.diag(own)))
    assert np.array(found.correlation)[:6, :6] == pytest.approx(correlation, abs=0.03)
    SerialArmResult.model_validate(found.model_dump())


def test_what_is_identified_alone_keeps_its_part() -> None:
    """Some of the base may be held."""
    plain = result()
    held = [plain.parameters[0].model_copy(update={"identified": False, "u": 0.0}), *plain.parameters[1:]]
    some = plain.model_copy(update={"parameters": held, "correlation": np.eye(6).tolist()})
    frame = np.diag([0.1, 0.1, 0.1, 1e-4, 1e-4, 1e-4]) ** 2
    wide, all_wide = with_frame_noise(some, frame).parameters, with_frame_noise(plain, frame).parameters
    assert wide[0].u == 0.0
    assert [one.u for one in wide[1:]] == pytest.approx([one.u for one in all_wide[1:]])

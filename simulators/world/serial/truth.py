"""True drivetrains of a serial arm, `catseye-joint-truth/1`: drawn from the seed, or read from a document."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from catseye.simulators.config import SerialArm, TruthText
from catseye.simulators.errors import TruthFileError
from catseye.simulators.world.types import Floats

FORMAT: Literal["catseye-joint-truth/1"] = "catseye-joint-truth/1"

NotNegative = Annotated[float, Field(ge=0.0)]
Positive = Annotated[float, Field(gt=0.0)]
Part = Annotated[float, Field(ge=0.0, lt=0.5)]


class _Document(BaseModel):
    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False)


class Wave(_Document):
    """A periodic error of a transmission: cos_deg · cos(order · link) + sin_deg · sin(order · link).

    Attributes:
        order: periods in a turn of the joint.
    """

    order: Positive
    cos_deg: float = 0.0
    sin_deg: float = 0.0


class JointTruth(_Document):
    """One drivetrain; torques and angles are those at the joint. Of one that slides, deg and N m stand for mm and N.

    Attributes:
        name: of the joint.
        stiffness_nm_per_deg: torsional, of the whole transmission.
        play_deg: width of its play.
        engagement_nm: torque over which it passes from one flank to the other.
        link_friction_nm: Coulomb friction behind the transmission.
        friction_waviness: how much each wave of the friction adds, as a part of it.
        friction_phases_deg: phases of the two waves.
        presliding_deg: length over which that friction grows after a reversal.
        creep: part of it that a rest takes away.
        creep_s: time constant of that.
        motor_friction_nm: Coulomb friction of motor and first stage.
        static_friction_nm: by how much that sticks at low speed (Stribeck).
        stribeck_deg_s: speed at which it no longer does.
        viscous_nm_s_per_deg: friction that grows with speed.
        servo_nm_per_deg: stiffness of the servo: friction that suddenly gives way lets the motor pass its target by
            `static_friction_nm` over this.
        stop_scatter_deg: standard deviation of where the servo comes to rest.
        stop_window_deg: it lets smaller errors of position be.
        encoder_noise_counts: standard deviation of a reading.
        encoder_error_deg: amplitude of the encoder's error that returns with each turn of the motor.
        torque_gain_error: by which part the drive states too much torque: motors differ, and warm.
        ringing_s: amplitude of the ringing after a motion over its speed.
        ringing_hz: its frequency.
        counterbalance_nm: largest torque of a balancer, which takes weight off the drive; 0 for none.
        counterbalance_zero_deg: angle at which it has no lever.
        waves: periodic errors, as harmonic drives have them.
        reversal_deg: what the link has more after a way from below than after one from above, beside what play and
            friction make.
        warming_deg: what hours of work add to the link.
        warming_s: time constant of that.
    """

    name: str
    stiffness_nm_per_deg: Positive
    play_deg: NotNegative
    engagement_nm: Positive
    link_friction_nm: NotNegative
    friction_waviness: Part = 0.03
    friction_phases_deg: tuple[float, float] = Field(default=(0.0, 0.0), strict=False)
    presliding_deg: Positive
    creep: Part = 0.05
    creep_s: Positive = 0.5
    motor_friction_nm: NotNegative
    static_friction_nm: NotNegative
    stribeck_deg_s: Positive = 1.0
    viscous_nm_s_per_deg: NotNegative = 0.0
    servo_nm_per_deg: Positive
    stop_scatter_deg: NotNegative
    stop_window_deg: NotNegative
    encoder_noise_counts: NotNegative = 0.5
    encoder_error_deg: NotNegative = 1e-5
    torque_gain_error: float = Field(default=0.0, gt=-1.0)
    ringing_s: NotNegative = 2e-4
    ringing_hz: Positive = 9.0
    counterbalance_nm: NotNegative = 0.0
    counterbalance_zero_deg: float = -90.0
    waves: tuple[Wave, ...] = Field(default=(), strict=False)
    reversal_deg: float = 0.0
    warming_deg: float = 0.0
    warming_s: Positive = 1200.0

    @property
    def overtravel_deg(self) -> float:
        """How far the motor passes its target at low speed."""
        return self.static_friction_nm / self.servo_nm_per_deg


class ArmTruth(_Document):
    """All drivetrains of an arm.

    Attributes:
        joints: from the base outwards.
    """

    format: Literal["catseye-joint-truth/1"]
    joints: tuple[JointTruth, ...] = Field(strict=False)


def column(truths: Sequence[JointTruth], name: str) -> Floats:
    """Return one value of each joint, shape (n,)."""
    return np.array([getattr(truth, name) for truth in truths], dtype=np.float64)


_COMPACT = {"motor_friction_nm": 50.0, "static_friction_nm": 15.0, "stop_window_deg": 1e-5}
"""Motors that drive their reducers directly."""

_REMOTE = {"engagement_nm": 1.5, "motor_friction_nm": 7.0, "static_friction_nm": 1.5, "stop_window_deg": 2e-5}
"""Motors behind the elbow, with shafts and bevel gears to the wrist."""

_LARGE: tuple[dict[str, float], ...] = (
    _COMPACT
    | {"stiffness_nm_per_deg": 120e3, "play_deg": 3e-3, "engagement_nm": 8.0, "link_friction_nm": 120.0}
    | {"presliding_deg": 4e-4, "servo_nm_per_deg": 700e3, "stop_scatter_deg": 1.2e-5},
    _COMPACT
    | {"stiffness_nm_per_deg": 100e3, "play_deg": 3e-3, "engagement_nm": 10.0, "link_friction_nm": 170.0}
    | {"presliding_deg": 6e-4, "servo_nm_per_deg": 400e3, "stop_scatter_deg": 4e-5}
    | {"counterbalance_nm": 2500.0},
    _COMPACT
    | {"stiffness_nm_per_deg": 70e3, "play_deg": 3e-3, "engagement_nm": 6.0, "link_friction_nm": 80.0}
    | {"presliding_deg": 6e-4, "servo_nm_per_deg": 300e3, "stop_scatter_deg": 3e-5},
    _REMOTE
    | {"stiffness_nm_per_deg": 19e3, "play_deg": 8e-3, "link_friction_nm": 28.0}
    | {"presliding_deg": 1.2e-3, "servo_nm_per_deg": 4.5e3, "stop_scatter_deg": 2e-4},
    _REMOTE
    | {"stiffness_nm_per_deg": 18e3, "play_deg": 9e-3, "link_friction_nm": 28.0}
    | {"presliding_deg": 1.2e-3, "servo_nm_per_deg": 4.5e3, "stop_scatter_deg": 2e-4},
    _REMOTE
    | {"stiffness_nm_per_deg": 12e3, "play_deg": 4e-3, "link_friction_nm": 22.0}
    | {"presliding_deg": 1.2e-3, "servo_nm_per_deg": 4e3, "stop_scatter_deg": 2e-4},
)
"""Assumptions of this emulation for an arm of 210 kg payload and 2.7 m reach: no maker states any of them. They are
chosen so that step errors and reversal errors come out in the size that the resolution paper reports (4.1, 4.2)."""

_WAVE_GEAR = {"engagement_nm": 0.3, "presliding_deg": 0.01, "stop_window_deg": 5e-5, "stop_scatter_deg": 1e-4}
"""Motors with strain wave gears."""

_SCARA: tuple[dict[str, float], ...] = (
    _WAVE_GEAR
    | {"stiffness_nm_per_deg": 300.0, "play_deg": 8e-3, "link_friction_nm": 2.0, "motor_friction_nm": 3.0}
    | {"static_friction_nm": 0.5, "servo_nm_per_deg": 2e3},
    _WAVE_GEAR
    | {"stiffness_nm_per_deg": 200.0, "play_deg": 7e-3, "link_friction_nm": 1.4, "motor_friction_nm": 2.0}
    | {"static_friction_nm": 0.3, "servo_nm_per_deg": 1.2e3},
    {"engagement_nm": 0.5, "presliding_deg": 2e-3, "stop_window_deg": 5e-5, "stop_scatter_deg": 1e-4}
    | {"stiffness_nm_per_deg": 2e3, "play_deg": 2e-3, "link_friction_nm": 10.0, "motor_friction_nm": 10.0}
    | {"static_friction_nm": 2.0, "servo_nm_per_deg": 1e4},
    {"engagement_nm": 0.02, "presliding_deg": 2e-3, "stop_window_deg": 1e-4, "stop_scatter_deg": 3e-4}
    | {"stiffness_nm_per_deg": 100.0, "play_deg": 1.5e-3, "link_friction_nm": 0.08, "motor_friction_nm": 0.1}
    | {"static_friction_nm": 0.02, "servo_nm_per_deg": 50.0},
)
"""Assumptions of this emulation for a SCARA of 3 kg payload, deg and N m or mm and N: no maker states any of them.
They are chosen so that a reversal loses what it loses on the bench whose SCARA carries the beam: about 21 mdeg within
0.05° at the first two joints, 3 mdeg at the last one."""

_HARMONIC_DRIVE = {"engagement_nm": 0.15, "presliding_deg": 0.01, "stop_window_deg": 1e-4, "ringing_hz": 14.0}

_SMALL: tuple[dict[str, float], ...] = (
    _HARMONIC_DRIVE
    | {"stiffness_nm_per_deg": 545.0, "play_deg": 0.002, "link_friction_nm": 0.5, "motor_friction_nm": 5.0}
    | {"static_friction_nm": 0.5, "servo_nm_per_deg": 4e3, "stop_scatter_deg": 4e-4},
    _HARMONIC_DRIVE
    | {"stiffness_nm_per_deg": 545.0, "play_deg": 0.002, "link_friction_nm": 0.5, "motor_friction_nm": 5.0}
    | {"static_friction_nm": 0.5, "servo_nm_per_deg": 4e3, "stop_scatter_deg": 4e-4},
    _HARMONIC_DRIVE
    | {"stiffness_nm_per_deg": 134.0, "play_deg": 0.002, "link_friction_nm": 0.15, "motor_friction_nm": 3.0}
    | {"static_friction_nm": 0.3, "servo_nm_per_deg": 2e3, "stop_scatter_deg": 4e-4},
    _HARMONIC_DRIVE
    | {"stiffness_nm_per_deg": 28.8, "play_deg": 0.006, "link_friction_nm": 0.5, "motor_friction_nm": 1.0}
    | {"static_friction_nm": 0.1, "servo_nm_per_deg": 400.0, "stop_scatter_deg": 1e-3},
    _HARMONIC_DRIVE
    | {"stiffness_nm_per_deg": 41.7, "play_deg": 0.004, "link_friction_nm": 0.33, "motor_friction_nm": 1.0}
    | {"static_friction_nm": 0.1, "servo_nm_per_deg": 400.0, "stop_scatter_deg": 1e-3},
    _HARMONIC_DRIVE
    | {"stiffness_nm_per_deg": 27.0, "play_deg": 0.006, "link_friction_nm": 0.45, "motor_friction_nm": 0.7}
    | {"static_friction_nm": 0.1, "servo_nm_per_deg": 300.0, "stop_scatter_deg": 1e-3},
)
"""An arm of 3 kg payload with harmonic drives. Stiffness is that of the six-axis paper's Table VII, of J1 that of J2;
play and friction give the backlash of its Table III; all else is an assumption: no maker states any of it."""

_WAVES_DEG = (
    ((1.0, 0.002), (2.0, 0.003), (200.0, 0.001)),
    ((1.0, 0.003), (2.0, 0.003), (200.0, 0.001)),
    ((1.0, 0.003), (2.0, 0.004), (200.0, 0.001)),
    ((1.0, 0.05), (2.0, 0.012), (200.0, 0.002)),
    ((1.0, 0.008), (2.0, 0.006), (200.0, 0.002)),
    ((1.0, 0.002), (2.0, 0.002), (200.0, 0.002)),
)
"""Orders and amplitudes of the errors of these harmonic drives: what weight and backlash leave of the angular ranges
of Table III; the fastest is that of the wave generator at a ratio of 100. Orders and shares are assumptions."""

_WARMING_DEG = 0.004
"""Standard deviation of what a warm joint of such an arm is off; an assumption."""

_SMALL_REACH_MM = 1500.0
"""Lengths of all links of an arm with harmonic drives; an assumption."""

_TYPICAL = {(False,) * 6: _LARGE, (False, False, True, False): _SCARA}
"""Drivetrains by whether the joints of an arm slide, from the base outwards."""

_TORQUE_SPREAD = 0.03
"""Standard deviation of the torque of a motor from what its current says; an assumption."""

_SPREAD = 0.08
"""Standard deviation of the logarithm of a drawn value."""

_DRAWN = (
    *("stiffness_nm_per_deg", "play_deg", "link_friction_nm", "presliding_deg", "motor_friction_nm"),
    *("static_friction_nm", "stop_scatter_deg"),
)


def draw_joint_truth(arm: SerialArm, seed: int) -> ArmTruth:
    """Draw plausible drivetrains: the same seed gives the same ones.

    Args:
        arm: six joints that turn, as on an arm of 210 kg payload or, if it is short, of 3 kg; or a SCARA of 3 kg.

    Raises:
        TruthFileError: the arm has other joints, and nobody knows what its drivetrains are like.
    """
    kinds = tuple(joint.prismatic for joint in arm.joints)
    if kinds not in _TYPICAL:
        names = ", ".join(joint.name for joint in arm.joints)
        raise TruthFileError(
            f"{arm.name}: drivetrains are drawn for six joints that turn and for a SCARA, it has {names}: "
            f"state them in a document of the format {FORMAT}"
        )
    small = not any(kinds) and sum(abs(one.a_mm) + abs(one.d_mm) for one in arm.joints) < _SMALL_REACH_MM
    rng = np.random.default_rng([seed, 20])
    gains = np.random.default_rng([seed, 25]).normal(0.0, _TORQUE_SPREAD, len(arm.joints)).tolist()
    truths = []
    typicals = _SMALL if small else _TYPICAL[kinds]
    for joint, typical, gain in zip(arm.joints, typicals, gains, strict=True):
        factors = np.exp(rng.normal(0.0, _SPREAD, len(_DRAWN)))
        drawn = {key: typical[key] * float(factor) for key, factor in zip(_DRAWN, factors, strict=True)}
        phases = rng.uniform(-180.0, 180.0, 2).tolist()
        truths.append(
            JointTruth.model_validate(
                typical
                | drawn
                | {"name": joint.name, "friction_phases_deg": phases, "torque_gain_error": gain}
            )
        )
    return ArmTruth(format=FORMAT, joints=_with_harmonic_drives(truths, seed) if small else tuple(truths))


def _with_harmonic_drives(truths: Sequence[JointTruth], seed: int) -> tuple[JointTruth, ...]:
    """Return drivetrains with the errors of their gears, in phases of the seed, and what warmth adds."""
    rng = np.random.default_rng([seed, 24])
    found = []
    for truth, waves in zip(truths, _WAVES_DEG, strict=True):
        phases = rng.uniform(-np.pi, np.pi, len(waves))
        drawn = tuple(
            Wave(order=order, cos_deg=float(size * np.cos(phase)), sin_deg=float(size * np.sin(phase)))
            for (order, size), phase in zip(waves, phases, strict=True)
        )
        warming_deg = _WARMING_DEG * float(rng.standard_normal())
        found.append(truth.model_copy(update={"waves": drawn, "warming_deg": warming_deg}))
    return tuple(found)


def read_joint_truth(text: TruthText, arm: SerialArm) -> ArmTruth:
    """Read the drivetrains of an arm.

    Args:
        text: document in the format `catseye-joint-truth/1`, a joint each in the order of the arm.

    Raises:
        TruthFileError: the document does not fit; the text names file and key.
    """
    try:
        truth = ArmTruth.model_validate_json(text.raw)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"]) or "(document)"
        raise TruthFileError(f"{text.source}: {key}: {first['msg']}") from error
    names, expected = [joint.name for joint in truth.joints], [joint.name for joint in arm.joints]
    if names != expected:
        raise TruthFileError(
            f"{text.source}: joints: it has {', '.join(names):.200}; {arm.name} has {', '.join(expected)}"
        )
    return truth


def joint_truth_document(truth: ArmTruth) -> Mapping[str, object]:
    """Return the drivetrains as `read_joint_truth` takes them, ready for `json.dump`."""
    return truth.model_dump(mode="json")

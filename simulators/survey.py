"""What instruments in the room see of a serial arm, and how well they measure. Plain data."""

from dataclasses import dataclass

Place = tuple[float, float, float]
"""x, y, z, mm; of a direction without a unit."""


@dataclass(frozen=True)
class Mark:
    """A nest for a retroreflector, or a mark of an optical CMM, as somebody drew it.

    Attributes:
        name: of a nest; marks have none.
        place_mm: its centre, in the frame of what carries it.
        normal: where it looks, of any length; None: everywhere.
    """

    name: str
    place_mm: Place
    normal: Place | None = None


@dataclass(frozen=True)
class SurveyConfig:
    """What instruments in the room see of a serial arm. Places of the room are in the arm's nominal base frame.

    Nobody states these figures; all are assumptions of this emulation, the noise in sizes that lead to Table V and
    section 2 of the six-axis paper.

    Attributes:
        targets: nests on the tool, in the frame of the flange.
        u_target_mm: standard deviation of a true nest from its drawing, each coordinate.
        tool_marks: marks of the optical CMM on the tool, in the frame of the flange; empty: nine on either side of
            the plate that the first three nests span.
        base_marks: marks on base and table.
        nests: fixed ones on the table; in the instrument's frame where base_seen is stated.
        base_seen: x, y, z in mm and angles about x, y, z in deg, R = Rz·Ry·Rx, of the arm's base in the instrument's
            frame, as an operator knows it; None: the instruments stand at their rough places, turned anyhow.
        cone_deg: half angle of the cone in which a nest's retroreflector is seen.
        mark_cone_deg: half angle of the cone in which a mark is.
        tracker_mm: rough place of the laser tracker, where no base_seen is stated.
        cmm_mm: rough place of the optical CMM, likewise.
        leans_deg: standard deviation of how far an instrument leans, where no base_seen is stated.
        u_seen_mm: standard deviation of a stated base_seen, each coordinate.
        u_seen_deg: of its angles.
        search_mm: radius around the beam in which the tracker finds a target.
        range_um: standard deviation of a distance, of one second.
        range_um_per_m: what it grows by.
        angle_um: standard deviation across the beam, of one second.
        angle_um_per_m: what it grows by.
        face_urad: standard deviation of the errors that change their sign with the face.
        zero_um: standard deviation of the constant error of all distances.
        instrument_drift_um: rms of the slow displacement of either instrument.
        instrument_drift_urad: rms of its slow rotation.
        base_drift_um: rms of the slow displacement of the arm's base on its table.
        base_drift_urad: rms of its slow rotation.
        mark_um: standard deviation of one mark in one frame of the CMM, each coordinate.
        volume_um: rms of the CMM's error that depends on the place in its volume.
        bar_mm: nominal length of the scale bar.
        u_bar_um: standard deviation of its true length from its certificate.
        cup: where the cup of the ballbar stands from the beginning; None: hands put it somewhere first.
        u_cup_mm: how well hands put it there, led by the arm, each coordinate.
        ballbar_mm: nominal length of the ballbar.
        ballbar_range_mm: largest deviation that it reads.
        ballbar_um: standard deviation of one reading.
        u_ballbar_um: standard deviation of its calibrated length.
        nest_um: how well a ball sits in its nest, each coordinate.
        growth_ppm: what links are longer after hours of motion at full speed; less duty and speed heat less.
        warm_up_s: time constant of that, and of cooling.
    """

    targets: tuple[Mark, ...] = ()
    u_target_mm: float = 0.05
    tool_marks: tuple[Mark, ...] = ()
    base_marks: tuple[Mark, ...] = ()
    nests: tuple[Mark, ...] = (
        Mark("world1", (350.0, -350.0, 20.0)),
        Mark("world2", (350.0, 350.0, 20.0)),
        Mark("world3", (-350.0, 350.0, 20.0)),
    )
    base_seen: tuple[Place, Place] | None = None
    cone_deg: float = 30.0
    mark_cone_deg: float = 45.0
    tracker_mm: Place = (2300.0, -300.0, 350.0)
    cmm_mm: Place = (2000.0, 300.0, 700.0)
    leans_deg: float = 1.0
    u_seen_mm: float = 3.0
    u_seen_deg: float = 0.1
    search_mm: float = 30.0
    range_um: float = 8.0
    range_um_per_m: float = 0.8
    angle_um: float = 8.0
    angle_um_per_m: float = 4.0
    face_urad: float = 4.0
    zero_um: float = 5.0
    instrument_drift_um: float = 8.0
    instrument_drift_urad: float = 4.0
    base_drift_um: float = 10.0
    base_drift_urad: float = 10.0
    mark_um: float = 60.0
    volume_um: float = 50.0
    bar_mm: float = 1000.0
    u_bar_um: float = 2.0
    cup: Place | None = None
    u_cup_mm: float = 0.15
    ballbar_mm: float = 300.0
    ballbar_range_mm: float = 1.0
    ballbar_um: float = 0.5
    u_ballbar_um: float = 1.0
    nest_um: float = 1.5
    growth_ppm: float = 150.0
    warm_up_s: float = 1200.0

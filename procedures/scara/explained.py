"""The SCARA's procedures, each in a paragraph and a sketch.

In the sketches ● is a joint seen from above, ▶ the interferometer on the flange of J4, ◁ a cat's eye reflector on
its stand.
"""

from typing import Final

from catseye.procedures.kit.explanation import Explanation

WARMUP: Final = Explanation(
    "J1 and J2 swing to and fro, and J4 keeps the beam on one reflector. At each visit to the reference pose, always "
    "from the same side, the distance is measured. The slope of these distances is the drift. The warm-up ends when "
    "the drift plus its uncertainty has been below its limit at several consecutive visits. Nobody needs to be "
    "present.",
    """\
top view          J2
       ↻ ●━━━━━━━━●
        J1         ╲  ↻
      (column)      ╲
                     ●▶┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄◁ reflector
                     J4    distance
                     interferometer

distance  ╭─╮ ╭──────────────────  drift below the limit
       ╭──╯ ╰─╯ visits, always from the same side
       ╰────────────────────────▶ time""",
)

BEAM_LEVEL: Final = Explanation(
    "The beam has to be level, or its height at a reflector changes with the distance. At several distances J4 and "
    "J3 move until the beam hits the centre of the reflector; the slope of a line through these heights is the "
    "beam's pitch. You turn the vertical screw of the mount as asked, and the pitch is measured again, until it is "
    "within the tolerance, uncertainty included.",
    """\
side view                near     middle      far
  ║  ║ J3 ↕                                     ┄ beam
  ║  ║                                ┄ ┄ ┄ ┄ ┄ ◁
  ║  ║                      ┄ ┄ ┄ ┄ ┄ ◁
┌─╨──╨─┐        ┄ ┄ ┄ ┄ ┄ ┄ ◁  ) pitch
│ int. ▶ ─ ─ ─ ─ ─ ─ ─ ─ ─ ─ ─ ─ ─ ─ ─ ─ ─ ─ ─  level
└───┬──┘
 vertical screw of          one reflector, looked at from
 the mount tilts it         poses at different distances""",
)

BEAM_TO_J4: Final = Explanation(
    "The beam should pass through the J4 axis. Close to a reflector, J4 turns to and fro within the window in which "
    "the beam returns, with the count unbroken. The slope of the length against the angle is the beam's offset from "
    "the axis. You move the stage sideways as asked, and the offset is measured again. Search for the reflectors "
    "afterwards: the aim from earlier searches is no longer valid.",
    """\
top view          ↑ +y: left of the beam
            ┌─────────────┐
  stage ↕   │   ▶━━━━━━━━━━━━━━━━━━━━━━━━━━━◁ reflector
  by its    │   ↕ offset  │     beam
  screw     │   + J4 axis │
            └─────────────┘
               ↻ J4 turns up and down

length      ╱ slope = offset
          ╱
        ╱─────────▶ angle of J4""",
)

REFLECTOR_SEARCH: Final = Explanation(
    "At poses spread over the workspace J4 turns until the beam returns from a reflector, and is then centred in the "
    "window over which it returns. All sightings together give the positions of the reflectors and the beam's zero "
    "direction θ40. The search adds poses where the aim is worst, until the aim is good enough for the whole "
    "measurement.",
    """\
top view        J2             ┄ ┄ scan by J4
        ●━━━━━━━●         ┄ ┄
       J1        ╲    ┄ ┄     ┌╌╌╌╌╌┐ rough place
                  ●▶━━━━━━━━━━━━━◁  │ of a reflector
                  J4  ┄ ┄     └╌╌╌╌╌┘
                          ┄ ┄
signal        ╭───╮
              │   │     centre of the window = direction
      ────────╯   ╰──────────▶ angle of J4
seen from several poses: place, and zero direction of J4""",
)

OPEN_LOOP: Final = Explanation(
    "This is the measurement itself. J1 and J2 go through their nodes, upwards and downwards, while J4 keeps the "
    "beam aimed at a reflector: open-loop tracking. At each command the change of the distance is measured, to one "
    "reflector after another. Take-up moves make each joint arrive from the intended side; closures return to an "
    "early pose and show drift. From all distances catseye identify determines the links and the error maps.",
    """\
top view                              ◁ P3
             J2 nodes ↻          ┄
     ↻ ●━━━━━●              ┄
      J1      ╲         ┄
     nodes     ●▶━━━━━━━━━━━━━━━━━━━━━━━━◁ P2
               J4 aims   distance
                  ┄
                       ┄
                            ◁ P1
measured: distance minus the dead path of its segment;
each node from below ▲ and from above ▼""",
)

REPEATABILITY: Final = Explanation(
    "The arm approaches the same poses again and again, as in ISO 9283, with the beam on each reflector in turn. "
    "Each pose has its own run-in, so that both joints always arrive upwards. The scatter of the distances is the "
    "repeatability along each beam; beams in different directions give the RP of the position. Warm up first: drift "
    "counts as scatter.",
    """\
top view                                 ◁ P3
        J2                           ┄
  ●━━━━━●      pose 1           ┄
 J1      ╲    ╱           ┄
          ●▶ ╱┄ ┄ ┄ ┄ ┄ ┄ ┄ ┄ ┄ ┄ ┄ ┄ ┄ ◁ P2
        J4  ·:·  arrivals ┄
            ···                  ┄
                                     ┄   ◁ P1
  run-in ╱▶ pose, thirty times
  RP = mean radius + 3 standard deviations""",
)

VALIDATION_PATH: Final = Explanation(
    "The tool moves along a straight line, or along a path from a file, that the identification has not used. At "
    "each point a tracker measures the position, or the interferometer the distance to a reflector. The residual "
    "error of the error map, compared with that of the conventional model, shows whether the result can be believed. "
    "Driven with the commands of catseye compensate, the path shows what the correction gains.",
    """\
top view           y
        J2         ↑ ┊ · to
  ●━━━━━●            ┊ ·
 J1      ╲           ┊ ·  points
          ╲━━━━━━━━━━●▶┄┄┄┄┄┄┄┄┄┄┄┄┄┄◁ reflector
                     ┊ · J4   distance
                     ┊ ·           or ▣ tracker:
                     ┊ · from        position
                     x = 200 mm
measured − predicted: conventional model, error map""",
    ("passes=1",),
)

RADIAL_ERROR_MOTION: Final = Explanation(
    "How far does the axis of J1 or J2 move sideways while the joint turns? You centre a ball or a cylinder on the "
    "axis and set an indicator against it, in x and y. The joint turns by itself, step by step, and back, and you "
    "type the indicator's readings. What remains once the eccentricity is removed (and the artefact's form, if you "
    "reverse it) is the radial error motion of ISO 230-7. catseye budget writes it into the error budget.",
    """\
top view, J1 (or J2) seen along its axis
                 ◷ indicator, y
                 │
              ╭──┴──╮
              │  ●  ├──◷ indicator, x
              ╰─────╯          both stand still
              artefact on the axis: ball or cylinder
      ↺ the joint turns, step by step, and back

reading − eccentricity (first harmonic) = error motion""",
    ('joints=["J1"]',),
)

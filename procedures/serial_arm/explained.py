"""The procedures of a serial arm, each in a paragraph and a sketch."""

from typing import Final

from catseye.procedures.kit.explanation import Explanation

INSTRUMENT_CHECK: Final = Explanation(
    "Is the instrument good enough today? It measures the nests of the world frame again and again and in both "
    "faces, a scale bar at several places, and the distances between the tool's targets against their file. The "
    "arm stands still: jog it before to where the targets look at the instrument. You lay the bar.",
    """\
top view
          ◁ nest 1         ◁ nest 2
              ┄             ┄
   scale bar    ┄         ┄        tool ▲ targets
   ◁━━━━━━━◁ ┄ ┄ ┄ ▣ ┄ ┄ ┄ ┄ ┄ ┄ ┄ ┄ ┄  ● on the arm,
    certified   ┄  tracker                which stands
    length    ┄
          ◁ nest 3

repeats: scatter     faces: two-face error     bar: length""",
    ("bar_mm=1000.012",),
)

TRACKER_WARMUP: Final = Explanation(
    "All axes are exercised by random poses; between the cycles the arm returns to a reference pose and the "
    "instrument measures a target of the tool there. The warm-up ends when the target's drift has been below its "
    "limit at several visits in a row.",
    """\
side view    ●━━━━●
            ╱      ╲ ↻
           ╱        ● tool
          ●          ▲ target ┄ ┄ ┄ ┄ ┄ ┄ ▣ tracker
          ┃ ↻                             on its stand
       ▔▔▔▔▔▔▔   reference pose, from below

position  ╭────────────────  drift below the limit
      ╭───╯  visits
      ╰─────────────────────▶ time""",
)

AXIS_ANALYSIS: Final = Explanation(
    "Each joint turns by itself through what is in sight and back; the instrument measures a target of the tool "
    "every few degrees. A circle through the places gives the axis. What differs from it is the tangential, "
    "radial and axial error; there and back differ by the backlash.",
    """\
               ·  ·  ▲ target of the tool
            ·        ╲    ┄
          ·           · ┄     ┄ ┄ ┄ ┄ ┄ ┄ ▣ tracker
         ·     ⊙     ·      radial ↗
          ·   axis  ·       tangential ↺
            ·     ·         axial ⊙ (along the axis)
               ·
 one joint turns, the others stand
 there ↺ and back ↻: the difference is backlash""",
)

TRACKER_CALIBRATION: Final = Explanation(
    "The arm goes to poses that identify its parameters best; at each one the tracker measures a target of the "
    "tool, or an optical CMM the pose of its plate. Every axis comes from below, so that play and friction act "
    "from one side. The nests on the table, measured again now and then, are the world frame and show drift. "
    "calibrate computes the arm.",
    """\
side view    ●━━━━●
            ╱      ╲
           ╱        ●  tool with targets
          ●          ▲┄ ┄ ┄ ┄ ┄ ┄ ┄ ┄ ┄ ▣ tracker or
          ┃           ▲    ┄ ┄ ┄ ┄ ┄ ┄    optical CMM
       ▔▔▔▔▔▔▔         ┄ ┄
       base      ◁   ◁   ◁ nests on the table: world frame

each pose: approached from 5° lower, settle, measure""",
    ("frames=true",),
)

TRACKER_VALIDATION: Final = Explanation(
    "Random poses that the calibration has not seen, measured in the same way. validate compares each measured "
    "position with what the drawn and the calibrated arm predict: the errors that are left, and whether the "
    "stated uncertainties explain them.",
    """\
side view    ●━━━━●        random poses all over
            ╱      ╲       the workspace
           ╱        ●
          ●          ▲┄ ┄ ┄ ┄ ┄ ┄ ┄ ┄ ┄ ▣ tracker or
          ┃                               optical CMM
       ▔▔▔▔▔▔▔      ◁   ◁   ◁ nests

error  ▆▇▅▃▂  drawn arm
       ▇▂     calibrated arm
       ─────────▶ distance measured − predicted""",
    ("count=60",),
)

BALLBAR_CUP: Final = Explanation(
    "Where does the cup of the ballbar stand? You lead a nest of the tool with its ball into the cup by pendant, "
    "down to its seat, and again with the tool turned. The joints tell the place, by the calibrated arm. Nothing "
    "moves by itself.",
    """\
side view    ●━━━━●
            ╱      ╲
           ╱        ●  tool
          ●          ┃
          ┃          ○ ball of the nest
       ▔▔▔▔▔▔▔       ∪ cup on the table
                     ┴
 led in by pendant, twice or more,
 each time with the tool turned otherwise""",
    ("result=arm.json",),
)

BALLBAR: Final = Explanation(
    "An independent check of length: a bar between the cup on the table and a nest of the tool. By commands of "
    "the calibrated arm the nest goes over part of a sphere about the cup; the bar shows how far the distance "
    "differs from its length. You hang the bar in and take it off when asked. Walk the path before the first run.",
    """\
side view    ●━━━━●
            ╱      ╲
           ╱        ● tool
          ●          ○ nest     · · ·
          ┃           ╲      ·   places on rings
       ▔▔▔▔▔▔▔         ╲ bar  ·  of a sphere
                        ╲    ·
                         ○ cup on the table
 elevation: above the horizontal; azimuth 0: towards
 the arm's base
 length error = read − nominal length of the bar""",
    ("result=arm.json",),
)

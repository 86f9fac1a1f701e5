"""The procedures of a serial arm, each in a paragraph and a sketch."""

from typing import Final

from catseye.procedures.kit.explanation import Explanation

INSTRUMENT_CHECK: Final = Explanation(
    "Is the instrument good enough today? It measures the nests of the world frame repeatedly and in both faces, a "
    "scale bar at several places, and the distances between the tool's targets, which are compared with the tool "
    "file. The arm stands still: first jog it to where the targets face the instrument. You place the bar.",
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
    "Random poses exercise all axes. Between cycles the arm returns to a reference pose, where the instrument "
    "measures a target of the tool. The warm-up ends when the target's drift has been below its limit at several "
    "consecutive visits.",
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
    "Each joint turns alone, through the range in which the instrument sees the target, and back. The instrument "
    "measures the target every few degrees. A circle fitted to these positions gives the axis; deviations from it "
    "are the tangential, radial and axial errors, and the two directions differ by the backlash.",
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
    "The arm goes to the poses that identify its parameters best. At each one a tracker measures a target of the "
    "tool, or an optical CMM measures the pose of the plate. Every axis approaches from below, so that play and "
    "friction always act from the same side. The nests on the table define the world frame; measuring them again at "
    "intervals shows drift. Afterwards catseye calibrate identifies the arm.",
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
    "The arm goes to random poses that the calibration has not used, measured in the same way. Afterwards catseye "
    "validate compares each measured position with the predictions of the nominal and of the calibrated arm: the "
    "remaining errors, and whether the stated uncertainties explain them.",
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
    "Where is the cup of the ballbar? With the teach pendant you bring a nest of the tool with its ball down to the "
    "seat of the cup, and once more with the tool turned. The position follows from the joints and the calibrated "
    "arm. Nothing moves by itself.",
    """\
side view    ●━━━━●
            ╱      ╲
           ╱        ●  tool
          ●          ┃
          ┃          ○ ball of the nest
       ▔▔▔▔▔▔▔       ∪ cup on the table
                     ┴
 led in by pendant, twice or more,
 each time with the tool turned differently""",
    ("result=arm.json",),
)

BALLBAR: Final = Explanation(
    "This is an independent check of length, with a bar between the cup on the table and a nest of the tool. "
    "Compensated commands move the nest over part of a sphere about the cup, and the bar shows by how much the "
    "distance deviates from its length. You mount the bar and take it off when asked. Walk the path before the first "
    "run.",
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

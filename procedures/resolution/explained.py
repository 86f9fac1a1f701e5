"""The tests of motion resolution, each in a paragraph and a sketch."""

from typing import Final

from catseye.procedures.kit.explanation import Explanation

_OPTICS = """\
top view      prism     beam 1
            ┌────◁━━━━━━━━━━━━━━━━━━━┓
 joint ⊙━━━━┤    ↕ spacing S         ▣ interferometer
       ↻    └────◁━━━━━━━━━━━━━━━━━━━┛ on a stand
              prism     beam 2
 a turn by θ makes one path longer: θ = arcsin(ΔL / S)

"""

RESOLUTION: Final = Explanation(
    "How small a step can a joint still make? Angular optics measure the angle of one joint. The joint moves in one "
    "direction by smaller and smaller steps, each added to the measured position. The error of each step divided by "
    "its size, averaged over eleven steps, gives the least increment step: the smallest one that stays within ±10 %. "
    "You mount and align the optics at every position.",
    _OPTICS
    + """\
angle              ▁▁▁▁▁▂▂▃▃▃▃  steps of decreasing size
          ▁▁▁▁▃▃▃▃▆▆
   ▁▁▁▁▁▅▅         least increment step: error ≤ 10 %
   ───────────────────────────▶ time""",
    ('joints=["A1"]', 'positions=["K3"]'),
)

RESOLUTION_ISO: Final = Explanation(
    "This is the test of ISO 230-2 with equal steps. A joint moves forwards, backwards and forwards again by steps "
    "of one size, then by steps of the next larger size. For each size the step errors show whether the joint "
    "follows, and the steps after a reversal show the lost motion. Optics and positions are those of the test with "
    "decreasing steps.",
    _OPTICS
    + """\
angle     ▂▄▆▄▂▄▆    steps of 0.001°: there, back, there
                     then 0.002°, 0.005° …
   ───────────────────────────▶ time""",
    ('joints=["A1"]', 'positions=["K3"]'),
)

BACKLASH: Final = Explanation(
    "How much motion is lost when a joint reverses? The joint steps forwards and backwards around a position; the "
    "distance between the two branches is the lost motion, from play and friction together. If the controller "
    "reports the motor torque, its sign shows whether the gear has changed flanks: the value is valid only then.",
    _OPTICS
    + """\
measured      ╱╱ ↔ lost motion (reversal error)
            ╱╱
          ╱╱
        ──────────▶ commanded     there ╱  back ╱""",
    ('joints=["A1"]', 'positions=["K3"]'),
)

RESOLUTION_CARTESIAN: Final = Explanation(
    "How small a step can the tool still make along a straight line? Linear optics measure along X, Y or Z of the "
    "base frame to a reflector on the tool, which moves in one direction by smaller and smaller steps. The result is "
    "compared with what the models of the joints predict for that pose.",
    """\
side view      ●━━━━━●
              ╱       ╲      linear
             ╱         ●      reflector
            ●           ┗━━◁┄┄┄┄┄┄┄┄┄┄▣── interferometer
            ┃            tool  beam        on a stand
         ▔▔▔▔▔▔▔        ←──→ steps along +X or −X

one set-up for each direction: the beam lies along it
step error = (measured − commanded) / commanded""",
    ("poses_deg=[[0, -90, 90, 0, 45, 0]]",),
)

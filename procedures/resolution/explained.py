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
    "How small a step does a joint still make? Angular optics show the angle of one joint. It moves in one "
    "direction by steps that become smaller and smaller, each added to where the joint is measured to stand. The "
    "error of each step over its size, averaged over eleven steps, tells the least increment step: the smallest "
    "one that stays within ±10 %. You mount and align the optics at every place.",
    _OPTICS
    + """\
angle              ▁▁▁▁▁▂▂▃▃▃▃  steps of decreasing size
          ▁▁▁▁▃▃▃▃▆▆
   ▁▁▁▁▁▅▅         least increment step: error ≤ 10 %
   ───────────────────────────▶ time""",
    ('joints=["A1"]', 'positions=["K3"]'),
)

RESOLUTION_ISO: Final = Explanation(
    "The test of ISO 230-2 with equal steps: a joint goes there, back, and there again by steps of one size; then "
    "the same with larger ones. For each size the error of the steps shows whether the joint follows, and the "
    "turn shows what is lost. Same optics and the same places as in the test with decreasing steps.",
    _OPTICS
    + """\
angle     ▂▄▆▄▂▄▆    steps of 0.001°: there, back, there
                     then 0.002°, 0.005° …
   ───────────────────────────▶ time""",
    ('joints=["A1"]', 'positions=["K3"]'),
)

BACKLASH: Final = Explanation(
    "What is lost when a joint turns back? It steps there and back around a place; between the branches lies the "
    "lost motion, play and friction together. The motor torque, where the controller tells it, shows whether the "
    "gear changed its flank: only then does the value hold.",
    _OPTICS
    + """\
measured      ╱╱ ↔ lost motion (reversal error)
            ╱╱
          ╱╱
        ──────────▶ commanded     there ╱  back ╱""",
    ('joints=["A1"]', 'positions=["K3"]'),
)

RESOLUTION_CARTESIAN: Final = Explanation(
    "How small a step does the tool still make along a straight line? Linear optics look along X, Y or Z of the "
    "base frame at a reflector on the tool. It moves by smaller and smaller steps in one direction. The result is "
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

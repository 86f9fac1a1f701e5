"""What the cell files of all systems say about runs that nobody watches."""

from typing import Final

UNATTENDED: Final = """\
[engine]
on_client_lost = "hold"                 # or "continue", "stop": when the terminal that holds control dies
# on_output_lost = "go-on"              # or "hold", "stop": when nobody reads a run's output [pipe, file: go-on;
                                        # terminal: hold]
hold_limit_s = 900                      # s until a waiting run ends if nobody is there to continue it; resumable

# [hooks]                               # a command that receives events of a run, as a line of JSON on its stdin
# on = ["run-ended", "prompt", "alarm"]
# command = ["/usr/local/bin/tell-the-lab", "lab-1"]
"""

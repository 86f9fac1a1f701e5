"""What the cell files of all systems say about runs that nobody watches."""

from typing import Final

UNATTENDED: Final = """\
[engine]
on_client_lost = "hold"                 # or "continue", "stop": when the terminal that holds control dies
# on_output_lost = "go-on"              # or "hold", "stop": when nobody reads what a run says [pipe, file: go-on;
                                        # terminal: hold]
hold_limit_s = 900                      # longest wait of a run that nobody is there to let go on; it can be resumed

# [hooks]                               # a command that is given events of a run: one line of JSON on its stdin
# on = ["run-ended", "prompt", "alarm"]
# command = ["/usr/local/bin/tell-the-lab", "lab-1"]
"""

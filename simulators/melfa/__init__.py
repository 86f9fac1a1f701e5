"""Robot controller emulator: R-protocol over TCP or a serial line, data link, MXT, with codecs of its own.

Written from the fact sheet `melfa`, sections 1.1 to 1.14, 1.16, 2, 4 and 5.3. Modelled: sessions, operation right,
servo, override, direct execution, programs that consist of plain statements, positions, signals, errors and their
log, variables, editing, files, parameters, monitors, joint jog with its dead-man, alarms with their rules of
reset, TEACH, stop at any moment. Not modelled: an interpreter of the language, procedural framing, the "HC"
framing, Cartesian jog, effects of parameters and tools. `choices` lists what no source says. Message texts are
this emulator's own.
"""

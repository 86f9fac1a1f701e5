"""Robot controller emulator: R-protocol over TCP, with a codec of its own.

Written from the fact sheet `melfa`, sections 1.2 and 1.5 to 1.14. Modelled: sessions, operation right, servo,
override, position reads, direct execution of motion statements, alarms, stop. Not modelled: program files and
their editing, JOG, procedural framing, the "HC" framing, data link, MXT. Message texts are this emulator's own.
"""

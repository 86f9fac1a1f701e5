"""Lines of the uMD1 and uMD2 displays.

Source: the layout in the open firmware and GUI of S. Goldwasser and J. Beck (lasersam594, snapshot of March 2025):
REF MEAS1 DISP1 VEL1 PHASE1 SEQ LOWCODE LOWDATA, and for three axes MEAS2 DISP2 VEL2 PHASE2 MEAS3 DISP3 VEL3 PHASE3.
The numbers here are examples in that layout, not recorded.
"""

ONE_AXIS = b"1500 1503 -31605 3 64 4711 10 100\r\n"
THREE_AXES = b"1500 1503 -31605 3 64 4712 0 0 1500 12 0 128 0 7 0 0\r\n"
BEAM_LOST = b"1500 0 -31605 0 64 4713 0 0\r\n"

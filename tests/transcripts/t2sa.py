"""Commands of T2SA as its public client sends them.

Source: lsst-ts/ts_lasertracker, python/lsst/ts/lasertracker/t2sa_model.py (commit 1a46fc24); its comments promise
ACK-300 or an error for each. The client sends the two indices without the sign with which its own mock
(mock/mock_t2sa.py, commit 02d3f060) knows them, and most of these settings are unknown to that mock.
"""

SETTINGS = (
    "SET_RANDOMIZE_POINTS:1",
    "SET_POWER_LOCK:0",
    "SET_NUM_SAMPLES:500",
    "SET_NUM_ITERATIONS:3",
    "INC_MEAS_INDEX:1",
    "SET_MEAS_INDEX:1",
    "!CLERCL",
    "!SINGLE_POINT_MEAS_PROFILE:fine",
    "!GEN_REPORT:night",
    "!SET_2FACE_TOL:0.001;0.001;0.1",
    "!SET_DRIFT_TOL:0.05;0.1",
    "!SET_LS_TOL:0.05;0.1",
    "!NEW_STATION",
    "!SET_STATION_LOCK:1",
    "!SAVE_SETTINGS",
    "!LOAD_TRACKER_COMPENSATION:C:\\comp.txt",
)

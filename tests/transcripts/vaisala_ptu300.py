"""Lines of Vaisala's PTU300 family, from its manual (M210796EN, commands FORM and SEND) and the sensors' sheet."""

DEFAULT_LINE = "P= 1013.2 hPa T= 31.1 'C RH= 38.3 %RH"
"""Answer to SEND after FORM /: 1013.2 hPa, 31.1 °C, 38.3 %RH."""

FORMATS = {
    '6.1 "P=" P " " U6 3.1 "T=" T " " U3 3.1 "RH=" RH " " U4 \\r \\n': "P= 1033.7 hPa T= 22.2 'C RH= 38.3 %RH",
    '"RH=" 4.2 rh U5 #t "T=" t U3 #r #n': "RH= 14.98%RH T= 74.68'F",
}
"""Format to the line that the manual shows for it; the manual's print has lost all but one of several spaces."""

READINGS = {
    '6.1 "P=" P " " U6 3.1 "T=" T " " U3 3.1 "RH=" RH " " U4 \\r \\n': (1033.7, 22.2, 38.3, "metric"),
    '"RH=" 4.2 rh U5 #t "T=" t U3 #r #n': (1000.0, (74.68 - 32.0) / 1.8, 14.98, "non metric"),
}
"""Format to what the sensor measured: hPa, °C, %RH, and its units."""

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

MSL_ANSWERS = {
    "UNIT": "Output units   : metric",
    "UNIT M": "Output units   : metric",
    "UNIT P hPa": "P units        : hPa",
    "ERRS": "No errors",
}
"""Lines that MSLNZ/msl-equipment compares character by character (msl/equipment/resources/vaisala/ptu300.py, commit
23e06f65). Before them it sends S, which nothing may answer, and `?`, whose lines it reads as `key: value` from the
second on until one names module 2; the first is model and version with ` / ` between them."""

MSL_FORMAT = '4.3 P " " 4.3 P3h " " 3.3 T " " 3.3 RH #r #n'
"""A format with the trend, as in its example; answered by OK, or shown again with backslashes."""

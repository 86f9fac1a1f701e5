"""Calls of attocube's Python API, retyped: method, parameters, how many values the client reads behind the number.

Sources: for `sen` the files displacement.py, adjustment.py, axis.py, realtime.py, network.py and nlc.py of the API
inside the package feather-xrol 0.1.1; for `ids` the files of the same names in the maker's repository
attocube-systems/IDS-APIs (folder python, commits 4221db3e, 07b58686, b0ebb6c6, e0fd3871 and f23ba11b). Calls that
both generations have alike (about.py, access.py, manual.py, update.py, system_service.py) stand under their full
names. Of the calls under WARNINGS the client reads the values whatever the number is; after a call under SETTERS it
sends `apply` or `discard` of the same service; of all others it reads the values only when the number is 0.
"""

WARNINGS = {
    "adjustment.getContrastInPermille": ((0,), 3),
    "displacement.getAbsolutePosition": ((0,), 1),
    "displacement.getAbsolutePositions": ((), 3),
    "displacement.getAxesDisplacement": ((), 3),
    "displacement.getAxisDisplacement": ((0,), 1),
    "displacement.getAxisSignalQuality": ((0,), 2),
    "displacement.getReferencePosition": ((0,), 1),
    "displacement.getReferencePositions": ((), 3),
    "nlc.getLutStatus": ((0,), 1),
}

SETTERS = {
    "axis.setMasterAxis": (1, "axis.getMasterAxis"),
    "axis.setPassMode": (1, "axis.getPassMode"),
    "realtime.setPeriodHsslClk": (80, "realtime.getPeriodHsslClk"),
    "realtime.setPeriodHsslGap": (3, "realtime.getPeriodHsslGap"),
    "realtime.setPeriodSinCosClk": (120, "realtime.getPeriodSinCosClk"),
    "realtime.setResolutionBissC": (5, "realtime.getResolutionBissC"),
    "realtime.setResolutionHsslHigh": (7, "realtime.getResolutionHsslHigh"),
    "realtime.setResolutionHsslLow": (6, "realtime.getResolutionHsslLow"),
    "realtime.setResolutionSinCos": (8, "realtime.getResolutionSinCos"),
    "realtime.setRtDistanceMode": (1, "realtime.getRtDistanceMode"),
    "realtime.setRtOutMode": (9, "realtime.getRtOutMode"),
}

GETTERS = {
    "axis.getMasterAxis": ((), 1),
    "axis.getPassMode": ((), 1),
    "realtime.getAafAttenuation": ((), 1),
    "realtime.getAafEnabled": ((), 1),
    "realtime.getAafWindow": ((), 1),
    "realtime.getHighPassCutOffFreq": ((), 1),
    "realtime.getLinearRange": ((), 1),
    "realtime.getTestChannelEnabled": ((), 1),
    "nlc.getLutApplied": ((0,), 1),
}

GETTERS_OF = {
    "ids": {
        "realtime.AafIsEnabled": ((), 1),
        "nlc.getDynamicNormalization": ((0,), 1),
        "nlc.getNonlinearityEstimation": ((), 1),
        "nlc.getVelocityThresholds": ((), 2),
    },
    "sen": {
        "axis.getAutoMasterAxis": ((), 1),
        "axis.getSupportedAxes": ((), 3),
        "realtime.getInvertedErrorSignal": ((), 1),
        "realtime.getRtAxisEnabled": ((0,), 1),
        "nlc.getLutDuringInit": ((), 1),
    },
}

NETWORK = "com.attocube.system.network."

NETWORK_GETTERS: dict[str, tuple[object, ...]] = {
    "getRealIpAddress": (),
    "getIpAddress": (),
    "getSubnetMask": (),
    "getDefaultGateway": (),
    "getDnsResolver": (0,),
    "getProxyServer": (),
    "getEnableDhcpServer": (),
    "getEnableDhcpClient": (),
    "getWifiPresent": (),
}

MANUAL = {
    "HumidityInPercent": (0.0, 45.5, 100.0),
    "PressureInHPa": (800.0, 987.6, 1200.0),
    "TemperatureInDegrees": (-40.0, 23.4, 100.0),
}
"""Quantities under com.attocube.ecu.manual (manual.py), set and read for an axis: lowest, some and largest value."""

SERVICE_GETTERS: dict[str, tuple[tuple[object, ...], int]] = {
    "com.attocube.system.about.getInstalledPackages": ((), 1),
    "com.attocube.system.errorNumberToRecommendation": ((0, 1), 1),
    "com.attocube.system.errorNumberToString": ((0, 1), 1),
    "com.attocube.system.getDeviceName": ((), 1),
    "com.attocube.system.getFirmwareVersion": ((), 1),
    "com.attocube.system.getFluxCode": ((), 1),
    "com.attocube.system.getHostname": ((), 1),
    "com.attocube.system.getMacAddress": ((), 1),
    "com.attocube.system.getSerialNumber": ((), 1),
    "com.attocube.system.update.getLicenseUpdateProgress": ((), 1),
    "com.attocube.system.update.getSwUpdateProgress": ((), 1),
    "getLockStatus": ((), 2),
}
"""Full names (about.py, access.py, system_service.py, update.py), parameters, values behind the number."""

SERVICE_ACTIONS: dict[str, tuple[object, ...]] = {
    "com.attocube.system.setDeviceName": ("bench 3",),
    "com.attocube.system.factoryReset": (),
    "com.attocube.system.update.uploadLicenseBase64": (0, "AAEC"),
    "com.attocube.system.update.uploadSoftwareImageBase64": (0, "AAEC"),
}
"""Those that succeed without a value."""

SERVICE_ACTIONS_OF: dict[str, dict[str, tuple[object, ...]]] = {
    "ids": {"com.attocube.system.apply": ()},
    "sen": {
        "com.attocube.system.softReset": (),
        "com.attocube.system.setTime": (28, 11, 2026, 3, 20, 59),
    },
}

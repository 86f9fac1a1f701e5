"""Modbus libraries behind the same names: `tcp` and `rtu` return the calls that the library has."""

"""Tests of simulators/modbus."""

"""Tests of simulators/control_port."""

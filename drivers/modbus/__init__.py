"""Modbus over TCP and RTU: registers, coils and inputs."""

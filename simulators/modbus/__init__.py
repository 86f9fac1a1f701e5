"""Modbus TCP server with the register map of an air sensor, both written here."""

"""Air sensors over Modbus TCP."""

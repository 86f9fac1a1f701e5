"""Air sensors over Modbus TCP and RTU, and in ASCII."""

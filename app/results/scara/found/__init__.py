"""What a run of a procedure of the SCARA has found by itself, without any identification."""

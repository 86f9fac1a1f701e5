"""Commands for a SCARA: its models, the paths and tables it is corrected with, its demonstration."""

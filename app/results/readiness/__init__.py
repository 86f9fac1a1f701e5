"""What a cell is ready for: what each procedure needs, and what comes next."""

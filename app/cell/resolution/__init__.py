"""What a cell file of a bench for motion resolution begins with."""

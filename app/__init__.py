"""What a person starts: command line, cell file, engine, run store, reports."""

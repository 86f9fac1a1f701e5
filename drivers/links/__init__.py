"""Links to devices: TCP, UDP, serial lines; requests and streams; recording and healing."""

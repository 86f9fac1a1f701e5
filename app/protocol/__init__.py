"""What crosses the engine's socket, once: requests, answers, events, snapshot, control states, the stop ladder.

`state`, `ladder` and `loss` are light; everything else imports pydantic, which the first screen does not wait for.
"""

"""Lets `python -m app` stand for the `catseye` command."""

from app.cli import main

main()

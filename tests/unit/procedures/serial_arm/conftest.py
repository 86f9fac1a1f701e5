"""Fixtures of the runs on a scripted tracker."""

from tests.unit.app.engine.at_once import written_at_once

__all__ = ["written_at_once"]

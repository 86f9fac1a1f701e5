"""Tests of the guard and of the lock of an arm."""

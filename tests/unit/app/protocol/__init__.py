"""Tests of the messages and rules that engine and front ends share."""

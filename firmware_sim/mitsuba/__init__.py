"""Scenes that mitsuba renders: physics for the simulated camera, and an oracle for the tests.

Needs the extra `sim`. Nothing is imported before a picture is asked for.
"""

"""The numbers that GRBL 1.1 answers with instead of `ok`."""

from enum import IntEnum


class Code(IntEnum):
    """Status codes, as in `error:N`."""

    EXPECTED_COMMAND_LETTER = 1
    BAD_NUMBER_FORMAT = 2
    INVALID_STATEMENT = 3
    NEGATIVE_VALUE = 4
    SETTING_DISABLED = 5
    SHORT_STEP_PULSE = 6
    NOT_IDLE = 8
    LOCKED = 9
    SOFT_LIMITS_NEED_HOMING = 10
    LINE_OVERFLOW = 11
    CHECK_DOOR = 13
    TRAVEL_EXCEEDED = 15
    INVALID_JOG_COMMAND = 16
    UNSUPPORTED_COMMAND = 20
    MODAL_GROUP_VIOLATION = 21
    UNDEFINED_FEED_RATE = 22
    COMMAND_VALUE_NOT_INTEGER = 23
    AXIS_COMMAND_CONFLICT = 24
    WORD_REPEATED = 25
    NO_AXIS_WORDS = 26
    INVALID_LINE_NUMBER = 27
    VALUE_WORD_MISSING = 28
    UNSUPPORTED_COORDINATE_SYSTEM = 29
    G53_INVALID_MOTION_MODE = 30
    AXIS_WORDS_EXIST = 31
    UNUSED_WORDS = 36


class Alarm(IntEnum):
    """Alarm codes, as in `ALARM:N`. After 1, 3, 6, 8 and 9 the position is lost; after 2 it is kept."""

    HARD_LIMIT = 1
    SOFT_LIMIT = 2
    ABORT_IN_MOTION = 3
    HOMING_RESET = 6
    HOMING_DOOR = 7
    HOMING_PULL_OFF = 8
    HOMING_APPROACH = 9


CRITICAL = {Alarm.HARD_LIMIT, Alarm.SOFT_LIMIT}
"""Alarms that wait for a reset before anything else is heard."""


class GrblError(Exception):
    """A line that is answered with `error:N`."""

    def __init__(self, code: Code) -> None:
        super().__init__(code.name)
        self.code = code

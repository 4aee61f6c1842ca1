"""What stands before the camera: where steps are shot out of the plan's order, a person is asked where it changes."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

from acquisition.plans import Step
from litrig.base.capture_folder.journal import Entry

AS_AT_FIRST = "Put everything back as it was at the start"


def arranged(wanted: Sequence[Step], todo: Sequence[Step], entries: Sequence[Entry]) -> list[Step]:
    """Return steps with what a person must do first: exactly where they want another arrangement than the one before.

    Parameters
    ----------
    wanted : the plan, in its order
    todo : steps of it, in the order in which they will be shot
    entries : the journal, whose last frame tells how things stand
    """
    asked: dict[int, str] = {}
    ask = ""
    for step in wanted:
        ask = step.ask or ask
        asked[step.step] = ask
    shot = [entry["step"] for entry in entries if entry["ev"] == "frame"]
    stands = asked.get(shot[-1], "") if shot else ""
    result = []
    for step in todo:
        needs = asked[step.step]
        result.append(replace(step, ask="" if needs == stands else needs or AS_AT_FIRST))
        stands = needs
    return result


def done_by_now(entries: Iterable[Entry], todo: Sequence[Step]) -> frozenset[int]:
    """Return the step for which the session went on hold until a person had done something, if it is the next."""
    holds = [entry for entry in entries if entry["ev"] in ("hold", "frame")]
    asked = holds[-1].get("asks") if holds else None
    return frozenset({asked} if todo and asked == todo[0].step else ())

"""A comparison in plain, aligned lines, or as JSON."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from acquisition.compare.comparison import Comparison, Measure
from acquisition.plans import Step
from acquisition.report.cells import pose_words

_MOST = 12
_WIDTH = 12


def lines_of(found: Comparison) -> list[str]:
    """Return the lines; a part without a difference says so."""
    said = [f"A  {found.names[0]}", f"B  {found.names[1]}"]
    parts: Sequence[tuple[str, Sequence[str]]] = (
        ("settings", list(_settings(found))),
        ("plan", list(_plan(found))),
        ("exposure", list(_exposure(found))),
        ("instruments", list(_instruments(found))),
        ("versions", list(_versions(found))),
    )
    for name, lines in parts:
        for index, line in enumerate(lines or ["the same"]):
            said.append(f"{name if index == 0 else '':{_WIDTH}} {line}")
    return said


def as_json(found: Comparison) -> Mapping[str, Any]:
    """Return it for programs."""
    plan = found.plan
    return {
        "a": found.names[0],
        "b": found.names[1],
        "settings": [asdict(setting) for setting in found.settings],
        "plan": {
            "same": len(plan.same),
            "renumbered": sum(one.step != other.step for one, other in plan.same),
            "moved": [
                {"step": one.step, "turntable_deg": turned_deg, "light_deg": lit_deg}
                for one, _, turned_deg, lit_deg in plan.moved
            ],
            "only_a": [step.step for step in plan.only_a],
            "only_b": [step.step for step in plan.only_b],
        },
        "camera": [asdict(setting) for setting in found.camera],
        "measures": {measure.name: asdict(measure) for measure in found.measures},
        "instruments": {"only_a": list(found.instruments[0]), "only_b": list(found.instruments[1])},
        "versions": {"a": list(found.versions[0]), "b": list(found.versions[1])},
    }


def _settings(found: Comparison) -> Iterator[str]:
    shown = found.settings[: 2 * _MOST]
    width = max((len(setting.key) for setting in shown), default=0)
    for setting in shown:
        yield f"{setting.key:{width}}  {_shown(setting.a)} → {_shown(setting.b)}"
    if (left := len(found.settings) - len(shown)) > 0:
        yield f"and {left} more keys; --json has them all"


def _plan(found: Comparison) -> Iterator[str]:
    plan = found.plan
    renumbered = sum(one.step != other.step for one, other in plan.same)
    if not (renumbered or plan.moved or plan.only_a or plan.only_b):
        return
    yield f"{_counted(len(plan.same))} of one pose" + (
        f", {renumbered} of them under another number" if renumbered else ""
    )
    if plan.moved:
        worst = max(plan.moved, key=lambda pair: max(pair[2], pair[3]))
        yield f"{_counted(len(plan.moved))} elsewhere, at most {max(worst[2], worst[3]):.2f}° (step {worst[0].step})"
    for name, steps in (("A", plan.only_a), ("B", plan.only_b)):
        if steps:
            yield f"{len(steps)} only in {name}: {_listed(steps)}"


def _exposure(found: Comparison) -> Iterator[str]:
    for setting in found.camera[:_MOST]:
        yield f"{setting.key} {_shown(setting.a)} → {_shown(setting.b)}, read back in {_counted(setting.steps)}"
    if not found.measures:
        yield "no step of one pose was shot in both"
    width = max((len(measure.name) for measure in found.measures), default=0)
    for measure in found.measures:
        median, worst = (_figure(measure, value) for value in (measure.median, measure.worst))
        yield f"{measure.name:{width}}  median {median}, worst {worst} (step {measure.worst_step})"


def _figure(measure: Measure, value: float) -> str:
    if measure.kind == "ratio":
        return f"× {value:.3f}"
    if measure.name == "clipped":
        return f"{100 * value:+.2f} %"
    return f"{value:+.3f}°" if measure.name == "turntable" else f"{value:+.4f}"


def _instruments(found: Comparison) -> Iterator[str]:
    for name, devices in zip(("A", "B"), found.instruments, strict=True):
        for device in devices:
            yield f"only {name}: {device}"


def _versions(found: Comparison) -> Iterator[str]:
    a, b = (", ".join(versions) or "unknown" for versions in found.versions)
    if a != b:
        yield f"litrig {a} → {b}"


def _counted(steps: int) -> str:
    return f"{steps} step" if steps == 1 else f"{steps} steps"


def _listed(steps: Sequence[Step]) -> str:
    words = [f"{step.step} ({pose})" if (pose := pose_words(step)) else f"{step.step}" for step in steps[:_MOST]]
    return ", ".join(words) + (", …" if len(steps) > _MOST else "")


def _shown(value: Any) -> str:
    if value is None:
        return "–"
    if isinstance(value, Mapping):
        return "given"
    if isinstance(value, list) and value and isinstance(value[0], Mapping):
        return f"{len(value)} entries"
    text = ", ".join(map(str, value)) if isinstance(value, list) else str(value)
    return text if len(text) <= 60 else text[:59] + "…"

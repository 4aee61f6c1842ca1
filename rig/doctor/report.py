"""The doctor's findings for people and for programs."""

from collections.abc import Iterator, Sequence
from typing import Any

from litrig.base.version import litrig_version
from rig.doctor.finding import Finding, State

LABELS = {State.OK: "ok", State.WARNING: "WARNING", State.FAULT: "FAULT"}


def is_healthy(findings: Sequence[Finding]) -> bool:
    """Tell whether a session may begin; warnings do not forbid it."""
    return all(finding.state is not State.FAULT for finding in findings)


def lines_of(finding: Finding) -> Iterator[str]:
    """Write a finding: a line, and one more with the next step if there is one."""
    yield f"{LABELS[finding.state]:<8} {finding.part}: {finding.name}: {finding.what}"
    if finding.next_step:
        yield f"{'':<8} → {finding.next_step}"


def summary(findings: Sequence[Finding]) -> str:
    """Count, in words."""
    faults, warnings = (sum(f.state is state for f in findings) for state in (State.FAULT, State.WARNING))
    if not faults and not warnings:
        return "healthy"
    counts = [f"{n} {word}{'s' * (n > 1)}" for n, word in ((faults, "fault"), (warnings, "warning")) if n]
    return f"{'not healthy' if faults else 'healthy'}: {', '.join(counts)}"


def as_json(rig_name: str, findings: Sequence[Finding], seconds: float) -> dict[str, Any]:
    """Return everything as one object."""
    return {
        "litrig": litrig_version(),
        "rig": rig_name,
        "healthy": is_healthy(findings),
        "seconds": round(seconds, 3),
        "findings": [finding.as_json() for finding in findings],
    }

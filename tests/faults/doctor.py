"""Faults that the doctor must name: a servo at another baud rate, two of one id, another model."""

import time
from pathlib import Path

from firmware_sim.config import SimConfig
from firmware_sim.launch import simulated_rig
from rig.config import RigConfig, TurntableConfig, read_rig
from rig.doctor.finding import Finding, State
from rig.doctor.passive import examine
from rig.doctor.servo import check_servo
from rig.fakes import FakeClock
from tests.faults.outcome import Outcome, Scale
from tests.rig.doctor.far_ends import TABLE, Together, bench, bus, servo

MOST_S = 5.0
BAUDS = (1_000_000, 9_600, 115_200, 2_000_000, 3_000_000, 4_000_000)
MODELS = ("XM430-W350", "XC430-W150", "XH430-W210")


def fault_14_wrong_baud(campaign: Scale) -> Outcome:
    """The servo listens at another baud rate than RIG.toml says: the doctor names it within 5 s."""
    wrong, slowest_s = 0, 0.0
    for trial in range(campaign.trials):
        baud = BAUDS[trial % len(BAUDS)]
        with simulated_rig(SimConfig.model_validate({"turntable": {"baud": baud}})) as sim:
            config = read_rig(sim.rig_toml)
            assert isinstance(config.turntable, TurntableConfig)
            table = config.turntable.model_copy(update={"baud": 57_600})
            start_s = time.monotonic()
            found = examine(RigConfig(turntable=table))
            took_s = time.monotonic() - start_s
        slowest_s = max(slowest_s, took_s)
        wrong += not (took_s < MOST_S and f"answers at {baud} baud, RIG.toml says 57600" in _faults(found))
    return Outcome(campaign.trials, wrong, f"the true baud rate named within {slowest_s:.1f} s", passed=wrong == 0)


def fault_15_id_clash(campaign: Scale) -> Outcome:
    """Two servos of one id talk at once, where a zero wins: refused, never taken for one healthy servo."""
    wrong = 0
    for trial in range(campaign.trials):
        clock = FakeClock(100.0)
        first, second = (bus(clock, servo(clock, at_deg=at)) for at in (30.0, 30.1 + 7.3 * trial))
        table = TurntableConfig(port="/dev/ttyTABLE")
        found = list(check_servo(bench(clock, Together(first, second), Path(), TABLE), table))
        wrong += "two servos have this id" not in _faults(found)
    return Outcome(campaign.trials, wrong, "the doctor says that two servos have the id", passed=wrong == 0)


def fault_16_wrong_model(campaign: Scale) -> Outcome:
    """The servo is of another model than RIG.toml says: the doctor names both."""
    wrong = 0
    with simulated_rig(SimConfig()) as sim:
        config = read_rig(sim.rig_toml)
        assert isinstance(config.turntable, TurntableConfig)
        for trial in range(campaign.trials):
            model = MODELS[trial % len(MODELS)]
            found = examine(RigConfig(turntable=config.turntable.model_copy(update={"model": model})))
            wrong += f"is a XL430-W250, RIG.toml says {model}" not in _faults(found)
    return Outcome(campaign.trials, wrong, "the doctor names the true model", passed=wrong == 0)


def _faults(found: list[Finding]) -> str:
    return "\n".join(finding.what for finding in found if finding.state is State.FAULT)

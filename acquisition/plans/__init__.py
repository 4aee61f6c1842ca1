"""What to shoot: plans are frozen data, know their length, and never how to get there."""

from acquisition.plans.limits import MOST_STEPS
from acquisition.plans.plan import Plan
from acquisition.plans.shorthand import amc_plan, ptm_plan
from acquisition.plans.step import Aim, Step

__all__ = ["MOST_STEPS", "Aim", "Plan", "Step", "amc_plan", "ptm_plan"]

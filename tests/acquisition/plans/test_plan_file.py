import re
from pathlib import Path

import pytest
from pydantic import BaseModel

from acquisition.plans import Plan, amc_plan, ptm_plan
from acquisition.plans.plan_file import (
    LitReferenceSection,
    PlanFile,
    PlanLightsSection,
    ReferenceSection,
    RingSection,
    TurnSection,
    read_plan,
)
from acquisition.plans.shooting import COVER_LENS
from litrig.base.capture_folder.capture import Role
from litrig.base.errors import ConfigError, InputError
from rig.config import AlwaysOnConfig, ArmConfig, RigConfig, SpindleLampConfig
from tests.acquisition.plans.test_light_path import DOME, dome_rig

EXAMPLES = Path(__file__).parents[3] / "examples"
NAMES = ("plan-amc.toml", "plan-ptm.toml", "plan-product.toml")
PTM = 'kind = "ptm"\n[lights]\ncount = 9\n'
AMC = 'kind = "amc"\n[turn]\nslices = 9\n'


def read(folder: Path, text: str, config: RigConfig | None = None) -> Plan:
    path = folder / "plan.toml"
    path.write_text(text, encoding="utf-8")
    return read_plan(path, config)


@pytest.mark.parametrize("name", NAMES)
def test_the_examples_are_plans(name: str) -> None:
    plan = read_plan(EXAMPLES / name)
    assert plan.kind in name
    assert len(plan) == len(list(plan)) > 200


@pytest.mark.parametrize("name", NAMES[:2])
def test_what_stands_commented_in_the_examples_are_the_defaults(name: str, tmp_path: Path) -> None:
    text = (EXAMPLES / name).read_text(encoding="utf-8")
    spoken = re.sub(r"^# (\w+ = .*)$", r"\1", text, flags=re.MULTILINE)
    spoken = re.sub(r"^revisit_every.*\n", "", spoken, flags=re.MULTILINE)
    silent = re.sub(r"^revisit_every.*\n", "", text, flags=re.MULTILINE)
    assert spoken.count("\n#") < silent.count("\n#")
    assert list(read(tmp_path, spoken)) == list(read(tmp_path, silent))


def test_the_examples_explain_every_key() -> None:
    text = "".join((EXAMPLES / name).read_text(encoding="utf-8") for name in NAMES)
    models: list[type[BaseModel]] = [
        PlanFile,
        TurnSection,
        PlanLightsSection,
        RingSection,
        ReferenceSection,
        LitReferenceSection,
    ]
    for model in models:
        for key, info in model.model_fields.items():
            assert re.search(rf"\b{key}\b( =|\])", text), f"{model.__name__}.{key}"
            assert info.description, f"{model.__name__}.{key}"


def test_a_file_of_nothing_special_is_the_shorthand_but_for_the_closure(tmp_path: Path) -> None:
    assert read(tmp_path, PTM) == ptm_plan(9)
    assert read(tmp_path, AMC) == amc_plan(9, closure=True)
    assert read(tmp_path, AMC + "closure = false") == amc_plan(9)


def test_less_than_a_turn_has_no_closure_unless_it_is_asked_for(tmp_path: Path) -> None:
    arc = AMC + "range_deg = 90\n"
    roles = [step.role for step in read(tmp_path, arc)]
    assert roles == [Role.FRAME] * 9
    assert [step.role for step in read(tmp_path, arc + "closure = true")][9:] == [Role.CLOSURE]


def test_a_list_of_lights_lies_beside_the_plan(tmp_path: Path) -> None:
    lines = "".join(f"{i}.jpg {i} 1 5\n" for i in range(7))
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "l.lp").write_text(f"7\n{lines}", encoding="utf-8")
    plan = read(tmp_path, 'kind = "ptm"\n[lights]\nfile = "sub/l.lp"\norder = "given"\n')
    assert [step.aim.azimuth_deg for step in plan if step.aim][:2] == [90.0, 45.0]
    with pytest.raises(InputError, match=r"plan\.toml: .*absent\.lp: no such file"):
        read(tmp_path, 'kind = "ptm"\n[lights]\nfile = "absent.lp"\n')


def test_a_domes_lamps_are_taken_within_the_cone(tmp_path: Path) -> None:
    text = 'kind = "ptm"\n[lights]\nmin_elevation_deg = 30\n'
    assert [step.aim.lamp for step in read(tmp_path, text, dome_rig()) if step.aim] == list(range(2, 12))
    assert len(read(tmp_path, 'kind = "ptm"\n[lights]\n', dome_rig())) == len(DOME)


def test_dark_frames_ask_for_the_lens_cap_where_the_rig_does_not_switch_all_light(tmp_path: Path) -> None:
    arm = ArmConfig(port="x")
    switched = RigConfig(arm=arm, lights=SpindleLampConfig(kind="grbl-spindle"))
    burning = RigConfig(arm=arm, lights=AlwaysOnConfig(kind="always-on"))
    dark = "[dark]\nframes = 2\n"
    asks = [
        [step.ask for step in read(tmp_path, text + dark, config) if step.ask]
        for text, config in ((PTM, None), (PTM, switched), (PTM, burning), (AMC, switched))
    ]
    assert asks == [[], [], list(COVER_LENS), list(COVER_LENS)]
    own = dark + 'ask = "Draw the curtain"\nask_after = "Open it"\n'
    assert [step.ask for step in read(tmp_path, AMC + own) if step.ask] == ["Draw the curtain", "Open it"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"key 'kind' is missing; add it"),
        ('kind = "amc"\n', r"a plan of kind amc needs \[turn\]; add it"),
        ('kind = "product"\n[turn]\nslices = 9\n', r"a plan of kind product needs \[lights\]; add it"),
        (AMC.replace("amc", "ptm"), r"a plan of kind ptm leaves \[turn\] alone; remove it, or use kind product"),
        (AMC + "[lights]\ncount = 9\n", r"a plan of kind amc leaves \[lights\] alone; remove it"),
        (AMC + "slises = 9\n", r"unknown key 'turn\.slises'; remove it or mend its spelling"),
        (AMC.replace("= 9", "= 1000000000"), r"turn\.slices: .*less than or equal to 100000 \(found 1000000000\)"),
        (AMC.replace("= 9", "= 0"), r"turn\.slices: .*greater than or equal to 1"),
        (AMC.replace("= 9", "= 7"), r"slices: 7 is outside 8\.\.100000"),
        (AMC.replace("= 9", "= nan"), r"turn\.slices: "),
        (AMC + "range_deg = nan\n", r"turn\.range_deg: .*finite"),
        (AMC + "start_deg = -inf\n", r"turn\.start_deg: .*finite"),
        (AMC + "range_deg = 720\n", r"turn\.range_deg: .*less than or equal to 360"),
        (AMC + "[white]\nframes = 0\n", r"white\.frames: .*greater than or equal to 1"),
        (AMC + "[dark]\nunder = 'one-light'\n", r"unknown key 'dark\.under'"),
        (AMC + "[chart]\nwhen = 'never'\n", r"chart\.when: "),
        ("bracket_ev = [0, 0]\n" + AMC, r"bracket_ev: has an exposure twice"),
        ("bracket_ev = []\n" + AMC, r"bracket_ev: "),
        ("bracket_ev = [nan]\n" + AMC, r"bracket_ev\.0: .*finite"),
        ("average = 1000\n" + AMC.replace("= 9", "= 5000"), r"5,000,\d+ steps, more than 100,000"),
        (PTM.replace("= 9", "= 5"), r"lights: 5 is outside 6\.\.2000"),
        (PTM.replace("count = 9", ""), r"count: is missing, for the rig has no dome"),
        (PTM + "rings = [{ elevation_deg = 9, count = 9 }]\n", r"leave out count and file"),
        (PTM + "min_elevation_deg = 81\n", r"81\.\.80° must rise"),
        (PTM + "azimuth_deg = [10, 5]\n", r"azimuth_deg: 10\.\.5° must rise"),
        (PTM + "order = 'spiral'\n", r"lights\.order: "),
    ],
)
def test_a_bad_plan_is_refused_in_one_line_that_names_the_key(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message) as refusal:
        read(tmp_path, text)
    assert str(refusal.value).startswith(str(tmp_path / "plan.toml"))
    assert "\n" not in str(refusal.value)

from pathlib import Path

import pytest

from litrig.base.config import parse_toml
from litrig.base.errors import ConfigError
from rig.config import RigConfig, read_rig

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_the_example_loads_and_its_comments_are_the_defaults(tmp_path: Path) -> None:
    text = (EXAMPLES / "rig.toml").read_text(encoding="utf-8")
    config = read_rig(EXAMPLES / "rig.toml")
    spelled_out = []
    for line in text.splitlines():
        told = line.removeprefix("# ")
        is_setting = line.startswith("# ") and " = " in told and told.split(" = ")[0].isidentifier()
        spelled_out.append(told if is_setting else line)
    full = parse_toml("\n".join(spelled_out), RigConfig, "rig.toml")
    # These have no default: the comments only show how they are written.
    bare = {"white_balance_k": None, "focus": None, "fps": None, "gain": None}
    assert full.camera is not None
    assert full.model_copy(update={"camera": full.camera.model_copy(update=bare), "sample": config.sample}) == config


@pytest.mark.parametrize(
    ("text", "message"),
    [
        pytest.param("[turntabel]\nport = 'x'", "unknown key 'turntabel'", id="misspelt section"),
        pytest.param(
            "[turntable]\nprot = 'x'",
            "key 'turntable.port' is missing; add it; unknown key 'turntable.prot'",
            id="misspelt key",
        ),
        pytest.param(
            "[turntable]\nport = 'x'\nmin_deg = 90\nmax_deg = 0", "between min_deg and max_deg", id="limits swapped"
        ),
        pytest.param(
            "[arm]\nport = 'x'\nview_from_arm = [[2,0,0],[0,1,0],[0,0,1]]", "must be a rotation", id="no rotation"
        ),
        pytest.param("[lights]\nkind = 'grbl-spindle'", "need an .arm.", id="lamp without its controller"),
        pytest.param("[lights]\nkind = 'candle'", "candle", id="unknown kind"),
        pytest.param("[camera]\ndevice = 'x'\npixel_format = 'H264'", "camera.pixel_format", id="unknown format"),
        pytest.param(
            "[sample]\nsphere_distance_radii = 0.5", "sample.sphere_distance_radii", id="camera inside the sphere"
        ),
    ],
)
def test_a_wrong_rig_is_refused_with_its_key(text: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        parse_toml(text, RigConfig, "rig.toml")

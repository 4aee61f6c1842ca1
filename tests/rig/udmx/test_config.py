from pathlib import Path

import numpy as np
import pytest

from litrig.base.config import parse_toml
from litrig.base.directions import direction_from_angles
from litrig.base.errors import ConfigError, InputError
from rig.config import RigConfig, read_rig
from rig.udmx.config import UdmxConfig
from rig.udmx.lights import levels

DOME_LP = "3\na.jpg 1 0 1\nb.jpg 0 -2 0\nc.jpg 0 0 5\n"


def lights_of(text: str) -> UdmxConfig:
    lights = parse_toml(f"[lights]\nkind = 'udmx'\n{text}", RigConfig, "rig.toml").lights
    assert isinstance(lights, UdmxConfig)
    return lights


def test_channels_count_from_one_and_slots_from_nought() -> None:
    lights = lights_of(
        "[[lights.lamp]]\nchannels = [1]\n[[lights.lamp]]\nchannels = [5, 3, 512]\ngain = [1.0, 0.5, 0.2]"
    )
    assert levels(lights, 0) == {0: 255, 4: 0, 2: 0, 511: 0}
    assert levels(lights, 1) == {0: 0, 4: 255, 2: 128, 511: 51}
    assert not any(levels(lights, None).values())


def test_a_fine_channel_follows_each_coarse_one() -> None:
    lights = lights_of("sixteen_bit = true\n[[lights.lamp]]\nchannels = [3]\ngain = 0.5")
    assert levels(lights, 0) == {2: 128, 3: 0}


def test_a_dome_file_gives_directions_in_the_order_of_the_channels(tmp_path: Path) -> None:
    (tmp_path / "dome.lp").write_text(DOME_LP, "utf-8")
    rig = tmp_path / "rig.toml"
    rig.write_text("[lights]\nkind = 'udmx'\ndome = 'dome.lp'\n", "utf-8")
    lights = read_rig(rig).lights
    assert isinstance(lights, UdmxConfig)
    assert [lamp.channels for lamp in lights.lamp] == [(1,), (2,), (3,)]
    found = np.array([direction_from_angles(*angles) for angles in lights.directions_deg])
    np.testing.assert_allclose(found, [[0.5**0.5, 0, 0.5**0.5], [0, -1, 0], [0, 0, 1]], atol=1e-6)
    # What a session keeps is whole: the dome's file is not needed to read it again.
    frozen = read_rig(rig).model_dump(exclude_none=True)
    assert RigConfig.model_validate(frozen) == read_rig(rig)


def test_a_dome_file_goes_with_lamps_of_ones_own(tmp_path: Path) -> None:
    (tmp_path / "dome.lp").write_text(DOME_LP, "utf-8")
    lamps = "".join(f"[[lights.lamp]]\nchannels = [{channel}]\ngain = 0.9\n" for channel in (10, 20, 30))
    resolved = lights_of(f"dome = 'dome.lp'\n{lamps}").resolved(tmp_path)
    assert [(lamp.channels, lamp.gain) for lamp in resolved.lamp] == [((10,), 0.9), ((20,), 0.9), ((30,), 0.9)]
    assert resolved.directions_deg[0] == (0.0, 45.0)
    with pytest.raises(ConfigError, match=r"dome\.lp: 3 lights for 1 lamps"):
        lights_of("dome = 'dome.lp'\n[[lights.lamp]]\nchannels = [10]").resolved(tmp_path)
    with pytest.raises(InputError, match=r"gone\.lp: no such file"):
        lights_of("dome = 'gone.lp'").resolved(tmp_path)


LAMP = "[[lights.lamp]]\nchannels = "


@pytest.mark.parametrize(
    ("text", "message"),
    [
        pytest.param("", "no lamps; add", id="no lamps"),
        pytest.param(f"{LAMP}[0]", r"lights\.lamp\.0\.channels\.0: .*greater than or equal to 1", id="channel nought"),
        pytest.param(f"{LAMP}[513]", "less than or equal to 512", id="channel 513"),
        pytest.param(f"{LAMP}[4]\n{LAMP}[3, 4]", "lamps 0 and 1 share channel 4", id="a channel twice"),
        pytest.param(f"sixteen_bit = true\n{LAMP}[4]\n{LAMP}[5]", "share channel 5", id="a fine channel in use"),
        pytest.param(f"sixteen_bit = true\n{LAMP}[512]", "needs channel 513", id="no room for the fine one"),
        pytest.param(f"{LAMP}[1, 2]\ngain = [0.5]", "2 channels have 1 gains", id="a gain too few"),
        pytest.param(f"{LAMP}[1]\ngain = 1.5", "less than or equal to 1", id="brighter than full"),
        pytest.param(f"{LAMP}[1]\nazimuth_deg = 5", "go together", id="half a direction"),
        pytest.param(
            f"{LAMP}[1]\nazimuth_deg = 5\nelevation_deg = 5\n{LAMP}[2]",
            "every lamp a direction, or none",
            id="one of two",
        ),
        pytest.param(f"port = 'usb3'\n{LAMP}[1]", r"lights\.port", id="no USB socket"),
        pytest.param(f"usb_backend = 'os;rm'\n{LAMP}[1]", r"lights\.usb_backend", id="no function"),
        pytest.param(f"chanel = 1\n{LAMP}[1]", r"unknown key 'lights\.chanel'", id="misspelt"),
    ],
)
def test_a_wrong_dome_is_refused_with_its_key(text: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        lights_of(text)

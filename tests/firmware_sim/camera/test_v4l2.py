"""OpenCV's own V4L2 code against the simulated camera, each test in a process with the shim preloaded."""

import itertools
import subprocess
from pathlib import Path

import numpy as np
import pytest

from firmware_sim.config import SphereScene
from firmware_sim.launch import RunningSim
from firmware_sim.scene.brushed_sphere import BrushedSphere
from firmware_sim.scene.pose import Pose
from firmware_sim.scene.sensor import Exposure, Sensor
from tests.firmware_sim.conftest import Client
from tests.firmware_sim.ports import turntable_of
from tests.firmware_sim.test_launch import eventually


def test_frames_come_with_rising_times_of_their_exposure(client: Client) -> None:
    said = client.run("""
camera = opened()
times = []
for _ in range(12):
    before = time.monotonic()
    ok, picture = camera.read()
    times.append(camera.get(cv2.CAP_PROP_POS_MSEC) / 1000)
    assert ok and picture.shape == (480, 640, 3) and times[-1] < time.monotonic()
say(times=times)
""")
    gaps = [after - before for before, after in itertools.pairwise(said["times"])]
    assert min(gaps) > 0.032


@pytest.mark.parametrize(
    ("width", "height", "fourcc", "got"),
    [
        pytest.param(640, 480, "MJPG", [480, 640], id="as asked"),
        pytest.param(1280, 720, "MJPG", [720, 1280], id="large"),
        pytest.param(320, 240, "YUYV", [240, 320], id="small and raw"),
        pytest.param(700, 500, "MJPG", [480, 640], id="the nearest size that there is"),
    ],
)
def test_the_client_chooses_size_and_format(
    client: Client, width: int, height: int, fourcc: str, got: list[int]
) -> None:
    said = client.run(f"""
camera = opened("{fourcc}")
camera.set(cv2.CAP_PROP_FRAME_WIDTH, {width})
camera.set(cv2.CAP_PROP_FRAME_HEIGHT, {height})
ok, picture = camera.read()
say(shape=picture.shape[:2], fourcc=int(camera.get(cv2.CAP_PROP_FOURCC)).to_bytes(4, "little").decode())
""")
    assert said == {"shape": got, "fourcc": fourcc}


def test_raw_jpeg_is_handed_out_as_it_came(client: Client) -> None:
    said = client.run("""
camera = opened()
camera.set(cv2.CAP_PROP_CONVERT_RGB, 0)
ok, content = camera.read()
height, width, space, subsampling = simplejpeg.decode_jpeg_header(content.tobytes())
say(header=[height, width, space, subsampling])
""")
    assert said["header"] == [480, 640, "YCbCr", "422"]


def test_both_formats_show_the_same_picture(client: Client) -> None:
    said = client.run("""
pictures = []
for fourcc in ("MJPG", "YUYV"):
    camera = opened(fourcc)
    pictures.append(fresh(camera).astype(int))
    camera.release()
say(difference=float(np.abs(pictures[0] - pictures[1]).mean()), mean=float(pictures[0].mean()))
""")
    assert said["mean"] > 30
    assert said["difference"] < 4


CONTROLS = [
    pytest.param("EXPOSURE", 50, "AUTO_EXPOSURE", 3, 1, id="exposure wants manual exposure"),
    pytest.param("WB_TEMPERATURE", 3000, "AUTO_WB", 1, 0, id="white balance wants no automatic"),
    pytest.param("FOCUS", 30, "AUTOFOCUS", 1, 0, id="focus wants no autofocus"),
]


@pytest.mark.parametrize(("control", "value", "automatic", "on", "off"), CONTROLS)
def test_what_is_automatic_cannot_be_set(
    client: Client, control: str, value: int, automatic: str, on: int, off: int
) -> None:
    said = client.run(f"""
camera = opened(manual=False)
say(automatic=camera.get(cv2.CAP_PROP_{automatic}), refused=camera.set(cv2.CAP_PROP_{control}, {value}),
    off=camera.set(cv2.CAP_PROP_{automatic}, {off}), taken=camera.set(cv2.CAP_PROP_{control}, {value}),
    got=camera.get(cv2.CAP_PROP_{control}))
""")
    assert said == {"automatic": on, "refused": False, "off": True, "taken": True, "got": value}


def test_other_controls_clamp_and_refuse_like_a_uvc_camera(client: Client) -> None:
    said = client.run("""
camera = opened()
say(gain=[camera.set(cv2.CAP_PROP_GAIN, 500), camera.get(cv2.CAP_PROP_GAIN)],
    brightness=[camera.set(cv2.CAP_PROP_BRIGHTNESS, -20), camera.get(cv2.CAP_PROP_BRIGHTNESS)],
    contrast=camera.set(cv2.CAP_PROP_CONTRAST, 5), mode=camera.set(cv2.CAP_PROP_AUTO_EXPOSURE, 2),
    fps=[camera.set(cv2.CAP_PROP_FPS, 10), camera.get(cv2.CAP_PROP_FPS)])
""")
    assert said == {
        "gain": [True, 100],
        "brightness": [True, -20],
        "contrast": False,
        "mode": False,
        "fps": [True, 10],
    }


def test_exposure_gain_and_brightness_change_the_picture_as_they_should(client: Client) -> None:
    said = client.run("""
def linear(picture):
    level = picture[180:300, 250:400].astype(float) / 255
    return float(np.where(level <= 0.04045, level / 12.92, ((level + 0.055) / 1.055) ** 2.4).mean())
camera = opened()
camera.set(cv2.CAP_PROP_EXPOSURE, 50)
short = fresh(camera)
camera.set(cv2.CAP_PROP_EXPOSURE, 100)
normal = fresh(camera)
camera.set(cv2.CAP_PROP_GAIN, 25)
gained = fresh(camera)
camera.set(cv2.CAP_PROP_GAIN, 0)
camera.set(cv2.CAP_PROP_BRIGHTNESS, 20)
bright = fresh(camera)
camera.set(cv2.CAP_PROP_BRIGHTNESS, 0)
camera.set(cv2.CAP_PROP_EXPOSURE, 5000)
flooded = fresh(camera)
say(half=linear(short) / linear(normal), double=linear(gained) / linear(normal),
    lift=float(bright.mean() - normal.mean()), clipped=float((flooded[180:300, 250:400] == 255).mean()))
""")
    assert said["half"] == pytest.approx(0.5, rel=0.05)
    assert 1.5 < said["double"] < 2.05  # highlights clip
    assert said["lift"] == pytest.approx(20, abs=0.5)
    assert said["clipped"] > 0.9


def test_defocus_blurs_and_automatic_exposure_finds_its_level(client: Client) -> None:
    said = client.run("""
camera = opened(manual=False)
camera.set(cv2.CAP_PROP_AUTOFOCUS, 0)
best = camera.get(cv2.CAP_PROP_FOCUS)
for _ in range(15):
    sharp = fresh(camera)
camera.set(cv2.CAP_PROP_FOCUS, 0)
blurred = fresh(camera)
def detail(picture):
    smooth = cv2.GaussianBlur(picture, (0, 0), 2).astype(float).mean(2)
    return float(np.quantile(np.hypot(*np.gradient(smooth)), 0.999))
say(best=best, sharp=detail(sharp), blurred=detail(blurred), mean=float(((sharp / 255.0) ** 2.2).mean()))
""")
    assert said["best"] == 120
    assert said["blurred"] < 0.5 * said["sharp"]
    assert said["mean"] == pytest.approx(0.12, rel=0.2)


def test_a_white_balance_below_neutral_is_bluer(client: Client) -> None:
    said = client.run("""
camera = opened()
camera.set(cv2.CAP_PROP_AUTO_WB, 0)
ratios = []
for temperature in (3000, 4600, 6500):
    camera.set(cv2.CAP_PROP_WB_TEMPERATURE, temperature)
    blue, _, red = fresh(camera)[180:300, 250:400].reshape(-1, 3).mean(0)
    ratios.append(float(blue / red))
say(ratios=ratios)
""")
    cold, neutral, warm = said["ratios"]
    assert cold > 1.2 * neutral > 1.2 * warm


def test_the_device_is_opened_by_one_at_a_time(client: Client) -> None:
    said = client.run("""
camera = opened()
second = opened()
camera.release()
third = opened()
say(first_two=[bool(camera.isOpened()), second.isOpened()], third=third.isOpened())
""")
    assert said == {"first_two": [False, False], "third": True}


def test_a_killed_client_leaves_the_camera_free(client: Client) -> None:
    with client.talk("camera = opened(); camera.read(); say(ready=True); sys.stdin.read()") as talk:
        talk.hear()
        assert client.run("say(opened=opened().isOpened())") == {"opened": False}
    assert client.run("camera = opened(); say(read=camera.read()[0])") == {"read": True}


def test_a_killed_client_wants_no_more_pictures(client: Client, sphere: RunningSim) -> None:
    with client.talk("camera = opened(); camera.read(); say(ready=True); sys.stdin.read()") as talk:
        talk.hear()
        assert sphere.side_channel.status()["camera"]["streaming"]
    assert eventually(lambda: not sphere.side_channel.status()["camera"]["streaming"])


def test_a_child_of_the_client_does_not_close_its_camera(client: Client) -> None:
    said = client.run("""
import subprocess
camera = opened()
camera.read()
subprocess.run(["true"], close_fds=False, check=True)
subprocess.run(["true"], check=True)
say(read=[camera.read()[0] for _ in range(3)])
""")
    assert said == {"read": [True] * 3}


@pytest.mark.parametrize("buffers", [1, 4])
def test_after_a_pause_stale_frames_come_first_one_a_buffer(client: Client, buffers: int) -> None:
    said = client.run(f"""
camera = opened()
camera.set(cv2.CAP_PROP_BUFFERSIZE, {buffers})
for _ in range({buffers + 2}):
    camera.read()
time.sleep(0.3)
now = time.monotonic()
stale = 0
while camera.read()[0] and camera.get(cv2.CAP_PROP_POS_MSEC) / 1000 < now:
    stale += 1
say(stale=stale)
""")
    in_flight = 2  # one exposure that was being computed, and one that had begun
    assert buffers <= said["stale"] <= buffers + in_flight


def test_a_fresh_frame_after_a_move_shows_the_new_pose(client: Client, sphere: RunningSim, tmp_path: Path) -> None:
    code = """
camera = opened()
for line in sys.stdin:
    np.save(line.strip(), fresh(camera)[..., ::-1])
    say(done=True)
"""
    scene, sensor = BrushedSphere(SphereScene()), Sensor(1e9, 0, 1)
    truths = {}
    with turntable_of(sphere) as table, client.talk(code) as talk:
        table.prepare(speed=200)
        for counts in (0, 512, 1024, 2560):
            table.go(counts)
            talk.tell(tmp_path / f"{counts}.npy")
            talk.hear()
            light = scene.light([Pose(counts * 360 / 4096, 0, 0, 0)], (480, 640))
            truths[counts] = sensor.expose(light, Exposure(0.01)).astype(int)
    for counts, truth in truths.items():
        others = [np.abs(other - truth).mean() for place, other in truths.items() if (place - counts) % 2048]
        off = np.abs(np.load(tmp_path / f"{counts}.npy") - truth).mean()
        assert off < 2.5
        assert min(others) > 5 * off


def test_frozen_frames_are_the_same_bytes_and_others_never(client: Client, sphere: RunningSim) -> None:
    code = """
camera = opened()
camera.set(cv2.CAP_PROP_CONVERT_RGB, 0)
for line in sys.stdin:
    fresh(camera)
    say(kinds=len({fresh(camera).tobytes() for _ in range(4)}))
"""
    kinds = []
    with client.talk(code) as talk:
        for frozen in (False, True):
            sphere.side_channel.request("camera.freeze", on=frozen)
            talk.tell()
            kinds.append(talk.hear()["kinds"])
    assert kinds == [4, 1]


def test_unplugged_reads_fail_at_once_and_nothing_opens(client: Client, sphere: RunningSim) -> None:
    code = """
camera = opened()
camera.read()
say(ready=True)
sys.stdin.readline()
say(read=[camera.read()[0] for _ in range(3)], is_opened=camera.isOpened())
"""
    with client.talk(code) as talk:
        talk.hear()
        sphere.side_channel.request("camera.unplug")
        talk.tell()
        assert talk.hear() == {"read": [False] * 3, "is_opened": True}
    assert client.run("say(opened=opened().isOpened())") == {"opened": False}
    sphere.side_channel.request("camera.unplug", on=False)
    assert client.run("say(opened=opened().isOpened())") == {"opened": True}


def test_a_hanging_camera_holds_its_reader_until_it_is_let_go(client: Client, sphere: RunningSim) -> None:
    code = """
camera = opened()
camera.read()
say(ready=True)
sys.stdin.readline()
say(read=camera.read()[0])
say(read=camera.read()[0])
"""
    with client.talk(code) as talk:
        talk.hear()
        sphere.side_channel.request("camera.hang")
        talk.tell()
        with pytest.raises(subprocess.TimeoutExpired):
            talk.process.wait(1)
        sphere.side_channel.request("camera.hang", on=False)
        assert [talk.hear(), talk.hear()] == [{"read": True}] * 2


def test_a_program_without_the_variables_sees_the_real_system(client: Client) -> None:
    said = client.run("""
import os
del os.environ["LITRIG_SIM_VIDEO"]
try:
    os.open("/dev/video42", os.O_RDWR)
    say(error=None)
except OSError as error:
    say(error=error.errno)
""")
    assert said["error"] == 2

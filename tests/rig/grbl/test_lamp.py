"""The lamp on the controller's output, which must go out when nobody is there any more."""

import pytest

from rig.errors import DeviceError
from rig.grbl.commands import Light, Move
from rig.grbl.controller import GrblController
from rig.grbl.output import Output
from tests.rig.grbl.bench import Bench


def homed(bench: Bench) -> GrblController:
    controller = bench.controller()
    controller.home(60)
    return controller


def test_the_lamp_goes_out_by_itself_when_nobody_speaks_any_more() -> None:
    bench = Bench()
    Output(homed(bench)).light(1000, limit_s=5)
    assert bench.sim.lamp.power == 1
    bench.clock.sleep(4.8)
    bench.wire.feed(b"")
    assert bench.sim.lamp.power == 1
    bench.clock.sleep(0.3)
    bench.wire.feed(b"")
    assert bench.sim.lamp.power == 0


def test_lighting_and_darkening_is_one_write_so_that_no_kill_falls_between() -> None:
    bench = Bench()
    controller = homed(bench)
    Output(controller).light(800, limit_s=30)
    assert b"G21G94G1F100M3S800.0\nG4P30.000\nM5\n" in [part for _, part in bench.port.written]


def test_the_position_is_read_while_the_lamp_burns_and_a_move_darkens_it_first() -> None:
    bench = Bench()
    controller = homed(bench)
    Output(controller).light(1000, limit_s=60)
    assert controller.position() == (-1, -1, -1)
    controller.command(Move({"X": -50}, 100))
    assert bench.sim.lamp.power == 0
    controller.finish_motion(10)
    assert controller.position()[0] == -50
    assert controller.homed


def test_lighting_again_starts_the_time_anew() -> None:
    bench = Bench()
    controller = homed(bench)
    for _ in range(3):
        Output(controller).light(1000, limit_s=5)
        bench.clock.sleep(4)
    bench.wire.feed(b"")
    assert bench.sim.lamp.power == 1


def test_without_a_limit_the_lamp_burns_on_through_moves() -> None:
    bench = Bench()
    controller = homed(bench)
    Output(controller).light(1000, None)
    controller.command(Move({"X": -50}, 100))
    controller.finish_motion(10)
    assert bench.sim.lamp.power == 1
    Output(controller).darken()
    assert bench.sim.lamp.power == 0


@pytest.mark.parametrize("place", range(20))
def test_a_byte_lost_on_the_way_to_the_lamp_is_noticed(place: int) -> None:
    bench = Bench()
    controller = homed(bench)
    bench.wire.drop_heard(place)
    Output(controller).light(1000, limit_s=60)
    assert bench.sim.lamp.power == 1


def test_a_spindle_that_somebody_has_turned_down_is_noticed() -> None:
    bench = Bench()
    controller = homed(bench)
    bench.wire.feed(b"\x9b")
    Output(controller).light(1000, limit_s=60)  # the reset of a second try takes the override back
    assert bench.sim.lamp.power == 1


def test_more_power_than_the_controller_gives_is_refused_and_not_dimmed() -> None:
    bench = Bench(settings={30: 500})
    with pytest.raises(DeviceError, match=r"exceeds the controller's full power \$30 = 500"):
        bench.lamp(homed(bench), power=1000).switch_on()
    assert bench.sim.lamp.power == 0


def test_the_lamp_shines_in_laser_mode_too() -> None:
    bench = Bench(settings={32: 1})
    controller = homed(bench)
    Output(controller).light(1000, limit_s=60)
    assert bench.sim.lamp.power == 1


def test_a_stop_darkens_the_lamp_and_keeps_the_position() -> None:
    bench = Bench()
    controller = homed(bench)
    Output(controller).light(1000, limit_s=60)
    controller.halt()
    assert bench.sim.lamp.power == 0
    assert controller.status().state == "Idle"
    assert controller.homed


def test_a_locked_controller_is_dark_and_darkening_it_is_no_error() -> None:
    bench = Bench(settings={21: 1})
    controller = homed(bench)
    Output(controller).light(1000, None)
    bench.sim.break_switches("stuck")
    with pytest.raises(DeviceError, match="alarm 1"):
        controller.position()
    controller.halt()
    assert controller.status().state == "Alarm"
    Output(controller).darken()
    assert bench.sim.lamp.power == 0


def test_light_is_a_command_like_others() -> None:
    bench = Bench()
    homed(bench).command(Light(300))
    assert 0 < bench.sim.lamp.power < 0.5

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_sim.render_queue import Job, RenderQueue
from firmware_sim.scene.pose import Pose


def job(angle_deg: float) -> Job:
    return Job(Pose(angle_deg, 0, 0, 1), (6, 8))


def counts(queue: RenderQueue) -> tuple[object, object]:
    progress = queue.progress()
    return progress["done"], progress["total"]


@given(st.lists(st.integers(0, 9)))
def test_every_picture_is_rendered_once_in_the_order_of_the_plan(angles: list[int]) -> None:
    queue = RenderQueue(room=100)
    queue.ahead(map(job, angles), anew=True)
    rendered = []
    while (following := queue.next()) is not None:
        rendered.append(following)
        queue.finished(following)
        assert counts(queue) == (len(rendered), len(set(angles)))
    assert rendered == [job(angle) for angle in dict.fromkeys(angles)]


def test_what_the_camera_waits_for_comes_first_and_the_latest_only() -> None:
    queue = RenderQueue(room=100)
    queue.ahead([job(1), job(2)], anew=True)
    queue.urgent(job(8))
    queue.urgent(job(9))
    assert queue.next() == job(9)
    queue.finished(job(9))
    assert queue.next() == job(1)
    assert counts(queue) == (0, 2)


def test_an_urgent_picture_of_the_plan_counts_for_the_plan() -> None:
    queue = RenderQueue(room=100)
    queue.ahead([job(1), job(2)], anew=True)
    queue.urgent(job(2))
    queue.finished(job(2))
    assert counts(queue) == (1, 2)
    assert queue.next() == job(1)


@pytest.mark.parametrize(
    ("anew", "left", "total"),
    [pytest.param(True, [3], 1, id="takes the place of the one before"), pytest.param(False, [2, 3], 3, id="goes on")],
)
def test_a_second_plan(anew: bool, left: list[int], total: int) -> None:
    queue = RenderQueue(room=100)
    queue.ahead([job(1), job(2)], anew=True)
    queue.finished(job(1))
    queue.ahead([job(3)], anew=anew)
    assert counts(queue) == (total - len(left), total)
    for angle in left:
        assert queue.next() == job(angle)
        queue.finished(job(angle))
    assert queue.next() is None


def test_a_plan_beyond_the_cache_says_what_it_leaves_out() -> None:
    queue = RenderQueue(room=2, note="slow")
    queue.ahead(map(job, range(5)), anew=True)
    assert counts(queue) == (0, 2)
    assert queue.progress()["note"] == ("slow; 3 pictures have no room in the cache: rendered when the rig gets there")


def test_the_first_failure_is_the_one_that_is_told() -> None:
    queue = RenderQueue(room=2)
    assert queue.progress()["failed"] == ""
    queue.fail("out of memory")
    queue.fail("ended by itself")
    assert queue.progress()["failed"] == "out of memory"

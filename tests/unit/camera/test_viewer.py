"""A viewer gets the newest picture, and no more than it can take; what it takes and misses is known."""

from server.access.identity import GUEST
from server.camera.picture import Picture
from server.camera.viewer import Viewer


def picture(number: int) -> Picture:
    return Picture(3, number, float(number), True, b"jpeg")


def looking() -> Viewer:
    viewer = Viewer(GUEST, "1.2.3.4")
    viewer.watch(3)
    viewer.turn(3, None, 0.0)
    return viewer


def taken(viewer: Viewer, *numbers: int) -> list[int]:
    """The numbers of the pictures that go out while those come from the camera."""
    sent = []
    for number in numbers:
        viewer.offer(picture(number), float(number))
        if viewer.is_hungry:
            sent.append(viewer.take().number)
    return sent


def test_two_pictures_may_be_on_their_way() -> None:
    viewer = looking()
    assert taken(viewer, 1, 2, 3, 4) == [1, 2]
    viewer.seen()
    assert viewer.is_hungry
    assert viewer.take().number == 4
    assert not viewer.is_hungry


def test_no_picture_comes_twice() -> None:
    viewer = looking()
    assert taken(viewer, 1) == [1]
    viewer.seen()
    assert not viewer.is_hungry


def test_words_about_more_pictures_than_came_win_nothing() -> None:
    viewer = looking()
    for _ in range(10):
        viewer.seen()
    assert taken(viewer, 1, 2, 3, 4) == [1, 2]


def test_another_camera_begins_with_its_newest_picture() -> None:
    viewer = looking()
    taken(viewer, 1, 2, 3)
    viewer.watch(4)
    viewer.turn(4, picture(9), 3.0)
    assert viewer.take().number == 9


def test_what_a_viewer_takes_a_second_and_since_when_it_has_missed_nothing() -> None:
    viewer = looking()
    taken(viewer, 1, 2, 3)
    assert viewer.rate(4.0) == 2 / 4
    assert viewer.complete(3.5) == 3.5  # the third one waits
    taken(viewer, 4)
    assert viewer.complete(4.5) == 0.5
    viewer.turn(3, None, 5.0)
    assert (viewer.rate(6.0), viewer.complete(6.0)) == (0, 1)


def test_who_may_not_look_any_more_gets_nothing() -> None:
    viewer = looking()
    viewer.offer(picture(1), 1.0)
    viewer.turn(None, None, 1.0)
    assert not viewer.is_hungry


def test_news_are_told_once_and_again_for_a_new_wish() -> None:
    viewer = looking()
    assert viewer.news("live") == '{"op":"camera","robot":3,"state":"live","reason":""}'
    assert viewer.news("live") == ""
    assert viewer.news("waiting", "why") == '{"op":"camera","robot":3,"state":"waiting","reason":"why"}'
    assert viewer.news("live")
    viewer.watch(3)
    assert viewer.news("live")

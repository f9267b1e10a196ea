"""A viewer gets the newest picture, and no more than it can take."""

from server.access.identity import GUEST
from server.camera.picture import Picture
from server.camera.viewer import Viewer


def picture(number: int) -> Picture:
    return Picture(3, number, float(number), True, b"jpeg")


def looking() -> Viewer:
    viewer = Viewer(GUEST, "1.2.3.4")
    viewer.watch(3)
    viewer.turn(3, None)
    return viewer


def taken(viewer: Viewer, *numbers: int) -> list[int]:
    """The numbers of the pictures that go out while those come from the camera."""
    sent = []
    for number in numbers:
        viewer.offer(picture(number))
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
    viewer.turn(4, picture(9))
    assert viewer.take().number == 9


def test_who_may_not_look_any_more_gets_nothing() -> None:
    viewer = looking()
    viewer.offer(picture(1))
    viewer.turn(None, None)
    assert not viewer.is_hungry


def test_news_are_told_once_and_again_for_a_new_wish() -> None:
    viewer = looking()
    assert viewer.news("live") == '{"op":"camera","robot":3,"state":"live","reason":""}'
    assert viewer.news("live") == ""
    assert viewer.news("waiting", "why") == '{"op":"camera","robot":3,"state":"waiting","reason":"why"}'
    assert viewer.news("live")
    viewer.watch(3)
    assert viewer.news("live")

"""Pictures: what is one, when it was taken, and how it goes to viewers."""

import struct

import pytest

from server.camera.clock import ClockOffset
from server.camera.multipart import Parts, StreamError
from server.camera.picture import Picture, dated, full_rate_of, picture_of
from tests.unit.camera.parts import BOUNDARY, JPEG, part

RECEIVED = 2000.0


def picture(body: bytes = JPEG, **headers: object) -> Picture:
    """The first one of Robot3, from a robot whose clock is 1000 s behind."""
    (one,) = Parts(BOUNDARY).feed(part(body, **{"X_Timestamp": "1000.000000", **headers}))
    return picture_of(one, 3, 1, ClockOffset(), RECEIVED)


def test_a_message_is_the_24_bytes_of_the_protocol_and_the_jpeg() -> None:
    message = Picture(3, 2**32 + 7, 1999.5, True, JPEG).message(2000.25)
    assert message[:24].hex() == "03000000" + "07000000" + struct.pack("<dd", 1999.5, 2000.25).hex()
    assert message[24:] == JPEG


def test_a_picture_was_taken_by_this_machines_clock() -> None:
    assert picture() == Picture(3, 1, RECEIVED, True, JPEG)


def test_what_ustreamer_tells_of_its_own_latency_counts() -> None:
    assert picture(X_UStreamer_Latency="0.250000").taken == RECEIVED - 0.25
    # while the camera is away, it is the time since the robot was switched on
    for since in ("24386.036000", "20.5"):
        assert picture(X_UStreamer_Latency=since, X_UStreamer_Online="false").taken == RECEIVED
    assert picture(X_UStreamer_Latency="soon").taken == RECEIVED


def test_a_camera_that_is_away_is_known_by_its_picture() -> None:
    assert not picture(X_UStreamer_Online="false").online
    assert picture(X_UStreamer_Online="true").online


def test_a_buffer_filled_up_with_zeros_is_still_a_picture() -> None:
    assert picture(JPEG + bytes(100)).jpeg == JPEG


@pytest.mark.parametrize("body", [b"", b"\xff\xd8\xff", JPEG[:-1], JPEG[1:], b"GIF89a", bytes(50)])
def test_what_does_not_begin_and_end_as_a_jpeg_is_an_error(body: bytes) -> None:
    with pytest.raises(StreamError, match="something else than pictures"):
        picture(body)


@pytest.mark.parametrize("stamp", [None, "", "now", "nan", "inf", "-1", "1e300"])
def test_a_picture_without_a_time_is_an_error(stamp: str | None) -> None:
    with pytest.raises(StreamError, match="when a picture was taken"):
        picture(X_Timestamp=stamp)


def test_a_camera_without_a_clock_takes_its_pictures_when_they_come() -> None:
    (one,) = Parts(BOUNDARY).feed(part(JPEG, X_Timestamp=None))
    assert picture_of(dated(one, RECEIVED), 3, 1, ClockOffset(), RECEIVED).taken == RECEIVED
    (other,) = Parts(BOUNDARY).feed(part(JPEG, X_Timestamp="1000.000000"))
    assert dated(other, RECEIVED) is other


@pytest.mark.parametrize(("told", "rate"), [("20", 20), ("0", 0), ("-5", 0), ("1000", 0), ("1e2", 0), ("", 0)])
def test_a_camera_that_can_be_asked_for_fewer_tells_its_full_rate(told: str, rate: int) -> None:
    (one,) = Parts(BOUNDARY).feed(part(X_Laserbot_Rate=told))
    assert full_rate_of(one) == rate


def test_other_cameras_are_not_asked() -> None:
    (one,) = Parts(BOUNDARY).feed(part())
    assert full_rate_of(one) == 0

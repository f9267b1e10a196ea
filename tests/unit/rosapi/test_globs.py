"""What a lab shows."""

import pytest

from server.access.globs import Globs


@pytest.mark.parametrize("globs", [Globs(), Globs((), (), ())])
def test_everything_is_shown_unless_something_is_said(globs: Globs) -> None:
    assert globs.allows_topic("/a") and globs.allows_service("/a") and globs.allows_param("/a")


def test_each_kind_has_its_own_patterns() -> None:
    globs = Globs(("/scan", "/camera/*"), ("/camera/set_*",), ("/open/*",))
    assert [name for name in ("/scan", "/scan2", "/camera/left/image", "/SCAN") if globs.allows_topic(name)] == [
        "/scan",
        "/camera/left/image",
    ]
    assert globs.allows_service("/camera/set_info") and not globs.allows_service("/camera/reset")
    assert globs.allows_param("/open/a/b") and not globs.allows_param("/open")


def test_rosapi_itself_is_never_hidden() -> None:
    globs = Globs(services=("/none",))
    assert globs.allows_service("/rosapi/topics")
    assert not globs.allows_service("/rosapi2/topics")

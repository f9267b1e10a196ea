"""A camera's stream as ustreamer 4.9 sends it, by the byte."""

BOUNDARY = b"boundarydonotcross"
HEAD = (
    b"HTTP/1.0 200 OK\r\n"
    b"Cache-Control: no-store, no-cache, must-revalidate, proxy-revalidate, pre-check=0, post-check=0, max-age=0\r\n"
    b"Pragma: no-cache\r\n"
    b"Expires: Mon, 3 Jan 2000 12:34:56 GMT\r\n"
    b"Set-Cookie: stream_client=0/5741d4b998c09e2d; path=/; max-age=30\r\n"
    b"Content-Type: multipart/x-mixed-replace;boundary=boundarydonotcross\r\n\r\n"
)
JPEG = b"\xff\xd8\xff\xe0 a picture \r\n--boundarydonotcross\r\n of a boundary \xff\xd9"


def part(body: bytes = JPEG, **headers: object) -> bytes:
    """With what ustreamer sets in front of it: `headers` by name, `_` for `-`, None for one that is missing."""
    told = {"Content_Type": "image/jpeg", "Content_Length": len(body), "X_Timestamp": "1795545856.456000", **headers}
    lines = [f"{name.replace('_', '-')}: {value}\r\n" for name, value in told.items() if value is not None]
    return b"--" + BOUNDARY + b"\r\n" + "".join(lines).encode() + b"\r\n" + body + b"\r\n"

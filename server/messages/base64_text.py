"""Bytes as text: the base64 of RFC 4648, section 4, in lines as Android, Java and mail write it, too."""

import binascii
import re

_OTHER = re.compile(r"[^A-Za-z0-9+/=]")


def decoded(text: str) -> bytes:
    """ValueError says what is wrong."""
    try:
        return binascii.a2b_base64(text, strict_mode=True)
    except ValueError:
        pass
    text = "".join(text.split())
    try:
        return binascii.a2b_base64(text, strict_mode=True)
    except ValueError as error:
        raise ValueError(_fault(text, error)) from None


def _fault(text: str, error: ValueError) -> str:
    other = _OTHER.search(text)
    if other is None:
        return f"not base64: {str(error).lower()}" if text else "not base64"
    if other[0] in "-_":
        return "base64 of the alphabet for URLs, with - and _; write + and /"
    return f"not base64, with {other[0]!r} in it"

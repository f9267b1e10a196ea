"""A stream of bytes taken apart into TCPROS messages: uint32 length, little endian, and that many bytes."""

from tcpros.header import LENGTH

MAX_LENGTH = 64 * 2**20  # bytes


class BlockError(ValueError):
    """Nobody means to send so much: the stream is broken."""


class Blocks:
    """`feed` it with what comes; it keeps the beginning of what is not complete yet."""

    def __init__(self) -> None:
        self.missing = 4  # bytes, at least, until something is complete
        self._begun = bytearray()

    def feed(self, data: bytes) -> list[bytes]:
        """The messages that are complete now. BlockError above MAX_LENGTH."""
        if self._begun:
            self._begun += data
            if len(data) < self.missing:
                self.missing -= len(data)
                return []
            data = bytes(self._begun)
            self._begun = bytearray()
        blocks: list[bytes] = []
        begin, total = 0, len(data)
        while True:
            if total - begin < 4:
                self.missing = 4 - (total - begin)
                break
            (length,) = LENGTH.unpack_from(data, begin)
            if length > MAX_LENGTH:
                raise BlockError(f"a message of {length} bytes, more than {MAX_LENGTH}")
            end = begin + 4 + length
            if end > total:
                self.missing = end - total
                break
            blocks.append(data[begin + 4 : end])
            begin = end
        if begin < total:
            self._begun += data[begin:]
        return blocks

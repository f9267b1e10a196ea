"""Calls of ROS services, without a thread per call (TCPROS: wiki.ros.org/ROS/TCPROS)."""

import asyncio
import io
import struct
from typing import Any
from urllib.parse import urlsplit

import genpy
import rosgraph

from server.rosbridge.conversion import ServiceType, Types
from server.rosbridge.ros import Registrar
from server.rosbridge.wire import RequestError

MAX_BLOCK_SIZE = 4 * 2**20  # bytes


class ServiceClient:
    """Calls services in the name of the node `caller`."""

    def __init__(self, registrar: Registrar, types: Types, caller: str) -> None:
        self._registrar, self._types, self._caller = registrar, types, caller
        self._master = rosgraph.Master(caller)

    async def call(self, service: str, args: Any, timeout: float) -> dict[str, Any]:
        """The response as a JSON object; RequestError says why there is none. `args`: JSON object or list."""
        try:
            async with asyncio.timeout(timeout):
                return await self._call(service, args)
        except TimeoutError:
            raise RequestError(f"no response within {timeout:g} s") from None
        except (OSError, EOFError) as error:
            raise RequestError(f"the connection to the service broke: {error}") from None

    async def _call(self, service: str, args: Any) -> dict[str, Any]:
        try:
            uri = await self._registrar.run(lambda: self._master.lookupService(service))
        except rosgraph.MasterError:
            raise RequestError("there is no such service") from None
        address = urlsplit(uri)
        reader, writer = await asyncio.open_connection(address.hostname, address.port)
        try:
            service_type = await self._shake_hands(service, reader, writer)
            buffer = io.BytesIO()
            service_type.request.decode(request_object(args, service_type), "").serialize(buffer)
            writer.write(struct.pack("<I", buffer.tell()) + buffer.getvalue())
            succeeded = await reader.readexactly(1)
            answer = await read_block(reader)
        finally:
            writer.close()
        if succeeded == b"\0":
            raise RequestError(answer.decode(errors="replace") or "the service failed")
        try:
            response = service_type.response.message_class().deserialize(answer)
        except genpy.DeserializationError as error:
            raise RequestError(f"the response is not a {service_type.name}: {error}") from None
        return service_type.response.encode(response)

    async def _shake_hands(
        self, service: str, reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> ServiceType:
        """The service tells its type when it is asked for any (md5sum *)."""
        header = {"service": service, "callerid": self._caller, "md5sum": "*"}
        writer.write(rosgraph.network.encode_ros_handshake_header(header))
        block = await read_block(reader)
        try:
            answer = rosgraph.network.decode_ros_handshake_header(struct.pack("<I", len(block)) + block)
        except (rosgraph.network.ROSHandshakeException, struct.error, ValueError) as error:
            raise RequestError(f"the service does not speak TCPROS: {error}") from None
        if "error" in answer:
            raise RequestError(answer["error"])
        service_type = self._types.service(answer.get("type", ""))
        if answer.get("md5sum") != service_type.md5sum:
            raise RequestError(f"the service has another version of {service_type.name} than rosbridge")
        return service_type


async def read_block(reader: asyncio.StreamReader) -> bytes:
    """A length (uint32, little endian) and that many bytes."""
    (length,) = struct.unpack("<I", await reader.readexactly(4))
    if length > MAX_BLOCK_SIZE:
        raise RequestError(f"the service sends {length} bytes, more than {MAX_BLOCK_SIZE}")
    return await reader.readexactly(length)


def request_object(args: Any, service_type: ServiceType) -> dict[str, Any]:
    """The request as an object: a list gives its fields in order."""
    if type(args) is dict:
        return args
    fields = service_type.request.message_class.__slots__
    if len(args) != len(fields):
        raise RequestError(f"{service_type.name} takes {len(fields)} arguments ({', '.join(fields)}), not {len(args)}")
    return dict(zip(fields, args, strict=True))

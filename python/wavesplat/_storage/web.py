"""Requests to web servers: redirects stay on the server's host, and no more bytes are read than are expected.

fsspec keeps the session and the thread that waits; its own `cat` reads a body to the end, whatever is in it.
"""

from __future__ import annotations

import re
import zlib
from http import HTTPStatus
from typing import Any, TypeAlias

from wavesplat._storage.addresses import is_public, safe_address
from wavesplat._system.libraries import library
from wavesplat.errors import FileError, LibraryError

#: Range of bytes: the first, and the one after the last; None is all, an end of None is the end of the file, and a
#: negative first byte counts from there.
Part: TypeAlias = "tuple[int, int | None] | None"

#: Timeouts in seconds: for the connection, for more bytes, and for the whole answer.
CONNECTING_S, WAITING_S, ANSWERING_S = 30.0, 30.0, 300.0
#: zlib's `wbits` for gzip or zlib.
ZLIB_OR_GZIP = 32 + 15
BLOCK_BYTES = 1 << 18
#: Status codes of something that is not there.
MISSING = (HTTPStatus.NOT_FOUND, HTTPStatus.GONE)
PORTS = {"http": 80, "https": 443}
#: An address whose parts behind the host are percent-encoded as a server gets them (RFC 3986), and are sent as typed.
ENCODED = re.compile(r"(?ai)https?://[\w.~:@\[\]-]+(?:[/?#](?:[\w.~:/?#\[\]@!$&'()*+,;=-]|%[0-9a-f]{2})*)?")


class ForbiddenError(Exception):
    """The server answers 403."""


class ServerError(FileError):
    """A server does not answer, or not now, or not whole: what it has may be sound."""


async def get(url: str, most: int, part: Part, *, public_only: bool) -> bytes | None:
    """The content at an address, of at most `most` bytes; None if there is none.

    Raises
    ------
    ForbiddenError
        If the server answers 403, which some do for what is not there.
    FileError
        If it answers something else, or more bytes.
    """
    headers = {} if part is None else {"Range": _range(part)}
    try:
        async with await _request(url, headers, public_only=public_only) as answer:
            if answer.status in MISSING:
                return None
            if answer.status == HTTPStatus.FORBIDDEN:
                raise ForbiddenError(url)
            if answer.status not in (HTTPStatus.OK, HTTPStatus.PARTIAL_CONTENT):
                raise _refusal(answer.status, url)
            body = await _body(answer, most, url)
            if part is None or answer.status == HTTPStatus.PARTIAL_CONTENT:
                return body
            return body[part[0] : part[1]]  # of a server that knows no ranges
    except (FileError, LibraryError, ForbiddenError):
        raise
    except Exception as error:  # noqa: BLE001 - raised without it: aiohttp quotes the query
        raise _as_file_error(error, url) from None


async def mark_of(url: str, *, public_only: bool) -> str | None:
    """The server's mark of an address's version: the ETag, or the time of the last change; None without one."""
    try:
        async with await _request(url, {}, public_only=public_only) as answer:
            if answer.status != HTTPStatus.OK:
                return None
            mark = answer.headers.get("ETag") or answer.headers.get("Last-Modified")
            return None if mark is None else str(mark)
    except (FileError, LibraryError, ForbiddenError):
        raise
    except Exception as error:  # noqa: BLE001 - raised without it: aiohttp quotes the query
        raise _as_file_error(error, url) from None


async def _request(url: str, headers: dict[str, str], *, public_only: bool) -> Any:
    """A request to a server, as an asynchronous context whose value is the answer."""
    aiohttp = library("aiohttp", extra="http")
    import fsspec
    import yarl

    files = fsspec.filesystem("http", get_client=_public_client if public_only else _client)
    # yarl writes %2F in a query as /, which signed addresses do not survive.
    where = yarl.URL(url, encoded=ENCODED.fullmatch(url) is not None)
    for host in (where.host or "", where.raw_host or ""):
        if public_only and _is_number(host) and not is_public(host):
            raise _not_public(host)
    session = await files.set_session()
    # An answer that is packed all the same is unpacked below, no further than is expected.
    wanted = {"Accept-Encoding": "identity", **headers}
    timeout = aiohttp.ClientTimeout(total=ANSWERING_S, sock_connect=CONNECTING_S, sock_read=WAITING_S)
    return session.get(where, headers=wanted, timeout=timeout)


async def _client(**options: Any) -> Any:
    """A session whose redirects stay on their host."""
    import aiohttp
    import yarl

    async def check_host(_: Any, __: Any, seen: Any) -> None:
        answer = seen.response
        target = answer.url.join(yarl.URL(answer.headers.get("Location") or answer.headers.get("URI") or ""))
        if not _is_same_host(answer.url, target):
            answer.close()
            place = safe_address(f"{target.scheme}://{target.authority}")
            raise FileError(
                f"the server of {answer.url.host} sends the request on to {place}, another place; open that address "
                f"itself if you trust it: {safe_address(str(answer.url))}"
            )

    trace = aiohttp.TraceConfig()
    trace.on_request_redirect.append(check_host)
    return aiohttp.ClientSession(auto_decompress=False, trace_configs=[trace], **options)


async def _public_client(**options: Any) -> Any:
    """A session that connects to public hosts only: names are resolved once, so they cannot change after the check."""
    import aiohttp
    from aiohttp.abc import AbstractResolver

    class PublicResolver(AbstractResolver):
        def __init__(self) -> None:
            self._own = aiohttp.ThreadedResolver()

        async def resolve(self, host: str, *given: Any, **more: Any) -> Any:
            found = await self._own.resolve(host, *given, **more)
            if not all(is_public(one["host"]) for one in found):
                raise _not_public(host)
            return found

        async def close(self) -> None:
            await self._own.close()

    return await _client(connector=aiohttp.TCPConnector(resolver=PublicResolver()), **options)


def _is_same_host(before: Any, after: Any) -> bool:
    """Whether a redirect stays on its host, scheme and port; http may become https."""
    if before.host != after.host or after.scheme not in PORTS:
        return False
    is_upgrade = (before.scheme, after.scheme) == ("http", "https")
    # A scheme's default port counts as no port.
    own = [url.port == PORTS[url.scheme] for url in (before, after)]
    return bool((before.scheme == after.scheme or is_upgrade) and (before.port == after.port or all(own)))


async def _body(answer: Any, most: int, url: str) -> bytes:
    """The content of an answer, unpacked if it is packed."""
    packing = answer.headers.get("Content-Encoding", "identity").lower()
    if packing not in ("identity", "", "gzip", "deflate", "x-gzip"):
        raise FileError(f"the server packs its answer by {packing!r}, though it was asked not to: {safe_address(url)}")
    too_long = FileError(
        f"the server sends more than the {most} bytes that can be there; the data are damaged, or not what they say: "
        f"{safe_address(url)}"
    )
    if (answer.content_length or 0) > most:
        answer.close()
        raise too_long
    unpacking = None if packing in ("identity", "") else zlib.decompressobj(ZLIB_OR_GZIP)
    content = bytearray()
    async for packed in answer.content.iter_chunked(BLOCK_BYTES):
        content += packed if unpacking is None else unpacking.decompress(packed, most + 1 - len(content))
        if len(content) > most:
            answer.close()
            raise too_long
    if unpacking is not None and (not unpacking.eof or unpacking.unused_data):
        raise FileError(
            f"damaged: the server's packed answer has no end, or more after it; try again: {safe_address(url)}"
        )
    return bytes(content)


def _range(part: tuple[int, int | None]) -> str:
    first, end = part
    return f"bytes={first}" if first < 0 else f"bytes={first}-{'' if end is None else end - 1}"


def _is_number(host: str) -> bool:
    """Whether aiohttp may connect to a host without the resolver: also 127.1 and 2130706433, as systems take them."""
    return ":" in host or host.replace(".", "").isdigit()


def _not_public(host: str) -> FileError:
    return FileError(
        f"the document names {host!r}, which is this machine or lies in a private network; if you trust it, pass "
        "external_files=True (--external-files)"
    )


def _refusal(status: int, url: str) -> FileError:
    """The error for an answer that has no content."""
    known = {one.value: one.phrase for one in HTTPStatus}
    reason = f"{status} {known.get(status, '')}".strip()
    if status == HTTPStatus.UNAUTHORIZED:
        place = "give an address that holds the access, ...?token=..."
        return FileError(f"the server asks for a log-in ({reason}); {place}: {safe_address(url)}")
    if status >= HTTPStatus.INTERNAL_SERVER_ERROR or status == HTTPStatus.TOO_MANY_REQUESTS:
        return ServerError(f"the server has a fault or is busy ({reason}); try again later: {safe_address(url)}")
    return FileError(f"the server does not give what is asked for ({reason}); check the address: {safe_address(url)}")


def _as_file_error(error: Exception, url: str) -> FileError:
    """An error of aiohttp in words for the user."""
    import aiohttp
    import yarl

    inner = getattr(error, "os_error", None)
    if isinstance(inner, FileError):
        return inner  # of the resolver of public hosts

    if isinstance(error, aiohttp.TooManyRedirects):
        return FileError(f"the server sends the request round in a circle; check the address: {safe_address(url)}")
    if isinstance(error, TimeoutError):
        return ServerError(f"the server does not answer within {WAITING_S:g} s; try again later: {safe_address(url)}")
    if isinstance(error, aiohttp.ClientConnectorError):
        return ServerError(
            f"there is no connection to the server ({inner or error}); check the address: {safe_address(url)}"
        )
    if isinstance(error, aiohttp.ClientPayloadError):
        return ServerError(f"truncated: the server ended its answer too early; try again: {safe_address(url)}")
    reason = (str(error).splitlines() or [""])[0] or type(error).__name__
    for name in (url, str(yarl.URL(url))):  # aiohttp quotes it whole
        reason = reason.replace(name, safe_address(name))
    return ServerError(
        f"the server cannot be asked, or not understood ({reason}); check the address: {safe_address(url)}"
    )

"""Addresses of volumes: the protocols that are opened, how parts of a path are appended, which hosts are public.

fsspec knows some thirty protocols and chains of them (`reference://::file://...`, `simplecache::http://...`); some read
other files, one renders templates out of the address itself. Only these few are handed on to it, one at a time.
"""

from __future__ import annotations

import ipaddress
from os import PathLike, fspath
from urllib.parse import quote, urlsplit

from wavesplat.errors import FileError

#: Protocols of addresses that are opened, here and in documents.
PROTOCOLS = ("http", "https", "s3", "gs", "file")
WEB = ("http", "https")
#: Characters of an address that a message quotes; data: addresses can be megabytes long.
MAX_LETTERS = 120
#: IPv6 addresses that stand for an IPv4 address in their last 32 bits (RFC 6052).
NAT64 = ipaddress.ip_network("64:ff9b::/96")
#: Range of global IPv6 addresses; site-local addresses (fec0::/10), for example, lie outside it.
UNICAST = ipaddress.ip_network("2000::/3")
#: Special-purpose addresses that only newer releases of Python know not to be public (IANA's registries, 2026):
#: protocols, relays of 6to4, documentation.
SPECIAL = [ipaddress.ip_network(net) for net in ("192.0.0.0/24", "192.88.99.0/24", "2001:db8::/32", "3fff::/20")]


def is_address(path: str | PathLike[str]) -> bool:
    """Whether a path is an address, `protocol://...`, not the name of a file."""
    name: object = fspath(path)
    return isinstance(name, str) and "://" in name


def is_web(address: str) -> bool:
    """Whether an address is one of a web server."""
    return address.partition("://")[0].lower() in WEB


def checked(address: str) -> str:
    """The address, or the path of a file on this machine that a `file://` address names.

    Raises
    ------
    FileError
        If it is a chain, has another protocol than these, or names no host.
    """
    protocol, _, rest = address.partition("://")
    if "::" in protocol or "::" in rest.partition("?")[0].partition("/")[2]:
        raise FileError(
            f"chains of protocols are not opened; give the address of the Zarr folder itself: {safe_address(address)}"
        )
    if protocol.lower() not in PROTOCOLS:
        raise FileError(
            f"{protocol[:MAX_LETTERS]}:// is not opened; use one of {', '.join(f'{one}://' for one in PROTOCOLS)}, "
            f"or copy the data to this machine: {safe_address(address)}"
        )
    try:
        parts = urlsplit(address)
        host, _ = parts.hostname, parts.port
    except ValueError as error:
        raise FileError(f"this is no address ({error}); check its host and port: {safe_address(address)}") from None
    if protocol.lower() == "file":
        if host not in (None, "", "localhost"):
            raise FileError(
                f"the file lies on {host}, not on this machine; mount its folder, or copy it: {safe_address(address)}"
            )
        from urllib.request import url2pathname  # 57 ms, which every start of the command line would pay

        return url2pathname(parts.path)
    if not host:
        raise FileError(f"the address names no host; write {protocol}://HOST/...: {safe_address(address)}")
    return address


def safe_address(path: str | PathLike[str]) -> str:
    """A path for messages; an address cut short, without user name, query and fragment, which may hold passwords."""
    text = str(path)
    return _without_passwords(text)[:MAX_LETTERS] if is_address(text) else text


def _without_passwords(address: str) -> str:
    """An address without user name, query and fragment."""
    protocol, _, rest = address.partition("?")[0].partition("#")[0].partition("://")
    host, slash, place = rest.partition("/")
    return f"{protocol}://{host.rpartition('@')[2]}{slash}{place}"


def check_no_address(path: str | PathLike[str], what: str) -> None:
    """Raise a `FileError` if an address is given where only files are read. `what`: such as "a scene"."""
    if is_address(path):
        raise FileError(
            f"{what} is read from a file on this machine, not from an address; save it, and give its path: "
            f"{safe_address(path)}"
        )


def below(address: str, key: str) -> str:
    """The address of `key` below an address: appended to its path, before the query."""
    base, mark, query = address.partition("?")
    return f"{base.rstrip('/')}/{quote(key)}{mark}{query}" if key else address


def last_part(address: str) -> str:
    """The last part of the path of an address, else its host, without what may be a password."""
    base = _without_passwords(address).rstrip("/")
    return base.rpartition("/")[2] or base


def is_public(host: str) -> bool:
    """Whether an IP address lies on the public internet: not this machine, nor the network that it is in."""
    try:
        address = ipaddress.ip_address(host.partition("%")[0])
    except ValueError:
        return False
    if isinstance(address, ipaddress.IPv6Address):
        inner = address.ipv4_mapped or address.sixtofour or (address.teredo[1] if address.teredo else None)
        if address in NAT64:
            inner = ipaddress.IPv4Address(int(address) & 0xFFFFFFFF)
        if inner is None and address not in UNICAST:
            return False
        address = inner or address
    return address.is_global and not address.is_multicast and not any(address in net for net in SPECIAL)

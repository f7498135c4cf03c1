"""Writer of VTK's XML images, in all the forms that VTK writes."""

from __future__ import annotations

import base64
import itertools
import lzma
import zlib

import numpy as np

KINDS = {"i": "Int", "u": "UInt", "f": "Float"}
PACK = {"vtkZLibDataCompressor": zlib.compress, "vtkLZMADataCompressor": lzma.compress}


def save_vti(
    path,
    arrays,
    *,
    form="appended",
    is_base64=False,
    compressor=None,
    byte_order="LittleEndian",
    header_type="UInt32",
    block=700,
    attributes='Origin="0 0 0" Spacing="1 1 1"',
    first=(0, 0, 0),
    of_cells=False,
    scalars="",
    n_pieces=1,
):
    """Write a file of arrays [z, y, x] or [z, y, x, component] by name; pieces are slabs along z that share points."""
    order = ">" if byte_order == "BigEndian" else "<"
    integer = np.dtype(header_type.lower()).newbyteorder(order)
    appended = b""

    def encode(*parts):
        return b"".join(base64.b64encode(part) if is_base64 or form == "binary" else part for part in parts)

    def encoded(data):
        if compressor is None:
            return encode(np.array([len(data)], integer).tobytes() + data)
        blocks = [data[i : i + block] for i in range(0, len(data), block)]
        packed = [PACK[compressor](part) for part in blocks]
        last = len(data) % block
        head = np.array([len(blocks), block, last, *map(len, packed)], integer)
        return encode(head.tobytes(), b"".join(packed))

    def element(name, samples):
        nonlocal appended
        kind = f"{KINDS[samples.dtype.kind]}{8 * samples.dtype.itemsize}"
        n = samples.shape[3] if samples.ndim > 3 else 1
        start = f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{n}" format="{form}"'
        if form == "ascii":
            return f"{start}>\n{' '.join(map(str, samples.ravel().tolist()))}\n</DataArray>"
        data = encoded(samples.astype(samples.dtype.newbyteorder(order)).tobytes())
        if form == "binary":
            return f"{start}>\n  {data.decode()}\n</DataArray>"
        offset, appended = len(appended), appended + data
        return f'{start} offset="{offset}"/>'

    depth, *plane = next(iter(arrays.values())).shape[:3]
    more = 1 if of_cells else 0
    tag = "CellData" if of_cells else "PointData"

    def extent(begin, end):
        sizes = [plane[1] - 1 + more, plane[0] - 1 + more]
        ends = [first[0], first[0] + sizes[0], first[1], first[1] + sizes[1], first[2] + begin, first[2] + end]
        return " ".join(map(str, ends))

    last = depth - 1 + more
    cuts = [last * k // n_pieces for k in range(n_pieces + 1)]
    pieces = []
    for begin, end in itertools.pairwise(cuts):
        own = {name: samples[begin : end + 1 - more] for name, samples in arrays.items()}
        data = "".join(element(name, samples) for name, samples in own.items())
        pieces.append(f'<Piece Extent="{extent(begin, end)}"><{tag} {scalars}>{data}</{tag}></Piece>')
    packed = "" if compressor is None else f' compressor="{compressor}"'
    xml = (
        f'<?xml version="1.0"?>\n<VTKFile type="ImageData" version="2.2" byte_order="{byte_order}" '
        f'header_type="{header_type}"{packed}>\n<ImageData WholeExtent="{extent(0, last)}" {attributes}>'
        f"{''.join(pieces)}</ImageData>"
    ).encode()
    if form == "appended":
        encoding = b"base64" if is_base64 else b"raw"
        xml += b'\n<AppendedData encoding="' + encoding + b'">\n_' + appended + b"\n</AppendedData>"
    path.write_bytes(xml + b"\n</VTKFile>\n")
    return path

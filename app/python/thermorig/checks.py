# SPDX-License-Identifier: MIT
"""Is a file what thermorig wrote? The check sums of docs/recording_format.md, "Rules"."""

from __future__ import annotations

import os
import stat
import zlib
from typing import Any, Iterator

import h5py
import numpy as np

ATTRIBUTE_SUMS = "quality/attribute_crc32"
BELIEVED = ("/@format", "/@simulated", "/quality@", "/rig", "/sync@", "/samples/reason_bits@")  # what Session reads
FILTERS = {h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_FLETCHER32}
DEFLATE_RATIO, SMALL_BYTES = 1032, 1 << 20  # deflate cannot shrink by more: whoever claims more wants our memory
PART_BYTES = 8 << 20


class NotASession(ValueError):
    """The file is no session of thermorig, is damaged, or of a format that this package does not read."""


def require_regular(path: str) -> None:
    """Opening a pipe waits, and opening a port moves its lines. Raises NotASession; OSError if it is not there."""
    mode = os.stat(path).st_mode
    if stat.S_ISDIR(mode):
        raise NotASession(f"{path}: is a folder, not a session")
    if not stat.S_ISREG(mode):
        raise NotASession(f"{path}: is not a regular file")


def require_unaltered(file: h5py.File) -> None:
    """Holds every dataset that thermorig wrote, and the attributes that Session believes, against their sums.
    Raises ValueError with what differs; whatever else a file may make of h5py passes through."""
    limit = os.stat(file.filename).st_size * DEFLATE_RATIO + SMALL_BYTES
    datasets = dict(_datasets(file))
    sums_text = datasets["/" + ATTRIBUTE_SUMS]
    if data_sum(sums_text, limit) != sums_text.attrs["crc32"]:
        raise ValueError(f"/{ATTRIBUTE_SUMS} differs from its check sum")
    found = dict(attribute_sums(file))
    for line in sums_text[()].decode().splitlines():
        expected, path = line[:8], line[9:]
        is_column = path.endswith("@crc32")
        if (is_column or path.startswith(BELIEVED)) and found.get(path) != expected:
            raise ValueError(f"{path} is missing, or differs from its check sum")
        if is_column and data_sum(datasets[path[:-len("@crc32")]], limit) != int(file[path[:-6]].attrs["crc32"]):
            raise ValueError(f"{path[:-6]}: its values differ from their check sum")


def data_sum(dataset: h5py.Dataset, limit: int = 1 << 62) -> int:
    """CRC-32 of a dataset's values. Raises ValueError for what no session of this size can hold."""
    if dataset.external or dataset.is_virtual:
        raise ValueError(f"{dataset.name}: its values are outside of the file")
    properties = dataset.id.get_create_plist()
    if not {properties.get_filter(i)[0] for i in range(properties.get_nfilters())} <= FILTERS:
        raise ValueError(f"{dataset.name}: has other filters than thermorig's")
    if dataset.id.get_space().get_simple_extent_npoints() * max(dataset.dtype.itemsize, 1) > limit:
        raise ValueError(f"{dataset.name}: claims to be larger than the file can hold")
    crc = 0
    if h5py.check_string_dtype(dataset.dtype):
        for text in np.ravel(dataset[()]):
            crc = zlib.crc32(_bytes_of(text).split(b"\0")[0] + b"\0", crc)
        return crc
    if not dataset.size:
        return crc
    row_bytes = dataset.dtype.itemsize * int(np.prod(dataset.shape[1:], dtype=np.int64))
    step = max(PART_BYTES // row_bytes, 1)
    if dataset.chunks:  # each is inflated once
        step = max(step // dataset.chunks[0], 1) * dataset.chunks[0]
    for first in range(0, len(dataset), step):
        crc = zlib.crc32(np.ascontiguousarray(dataset[first:first + step]).data, crc)
    return crc


def attribute_sums(file: h5py.File) -> Iterator[tuple[str, str]]:
    """Of each attribute of numbers or text its path ("/gyro@signal") and the CRC-32 of type, shape and values."""
    for path, thing in _objects(file):
        for name in thing.attrs.keys():
            crc = _attribute_sum(h5py.h5a.open(thing.id, name.encode()), thing.attrs, name)
            if crc is not None:
                yield f"{path}@{name}", f"{crc:08x}"


def _objects(file: h5py.File) -> list[tuple[str, Any]]:
    """All that hard links reach: others may lead out of the file."""
    found: list[tuple[str, Any]] = [("/", file)]
    file.visititems(lambda name, thing: found.append((f"/{name}", thing)))
    return found


def _datasets(file: h5py.File) -> Iterator[tuple[str, h5py.Dataset]]:
    return ((path, thing) for path, thing in _objects(file) if isinstance(thing, h5py.Dataset))


def _attribute_sum(attribute: h5py.h5a.AttrID, attributes: h5py.AttributeManager, name: str) -> int | None:
    kind, space = attribute.get_type(), attribute.get_space()
    numbers = (h5py.h5t.INTEGER, h5py.h5t.FLOAT)
    is_text = kind.get_class() == h5py.h5t.STRING
    if not is_text and kind.get_class() not in numbers:
        return None  # thermorig writes none; dimension scales are HDF5's own
    is_variable = is_text and kind.is_variable_str()
    shape = space.get_simple_extent_dims() if space.get_simple_extent_type() == h5py.h5s.SIMPLE else ()
    sign = kind.get_sign() if kind.get_class() == h5py.h5t.INTEGER else 0
    order = kind.get_order() if kind.get_class() in numbers else 0
    described = (f"{kind.get_class()} {0 if is_variable else kind.get_size()} {sign} {order} "
                 f"{space.get_simple_extent_type()} {'x'.join(map(str, shape))}\n").encode()
    if is_variable:
        texts = np.ravel(attributes[name])
        return zlib.crc32(described + b"".join(_bytes_of(text) + b"\0" for text in texts))
    values = np.empty(shape, f"V{kind.get_size()}")
    if values.size:
        attribute.read(values, mtype=kind)
    return zlib.crc32(described + values.tobytes())


def _bytes_of(text: Any) -> bytes:
    return text if isinstance(text, bytes) else str(text).encode("utf-8", "surrogateescape")

# SPDX-License-Identifier: MIT
"""Reads MCAP files as https://mcap.dev/spec has them, and believes nothing: every check sum, index, offset and count
that the specification defines is held against the bytes."""
import struct
import zlib
from dataclasses import dataclass, field

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX = range(1, 9)
STATISTICS, METADATA, METADATA_INDEX, SUMMARY_OFFSET, DATA_END = 0x0B, 0x0C, 0x0D, 0x0E, 0x0F


class Malformed(Exception):
    pass


def require(condition, what):
    if not condition:
        raise Malformed(what)


class Fields:
    """The fields of a record, one after another."""

    def __init__(self, content):
        self.content, self.at = content, 0

    def take(self, count):
        require(self.at + count <= len(self.content), "a record ends too early")
        self.at += count
        return self.content[self.at - count:self.at]

    def number(self, form):
        return struct.unpack("<" + form, self.take(struct.calcsize("<" + form)))[0]

    def numbers(self, forms):
        return [self.number(form) for form in forms]

    def text(self):
        return self.take(self.number("I")).decode("utf-8")

    def map(self, key, value):
        inner = Fields(self.take(self.number("I")))
        entries = {}
        while inner.at < len(inner.content):
            name = key(inner)
            require(name not in entries, "a key is there twice")
            entries[name] = value(inner)
        return entries

    def end(self):
        require(self.at == len(self.content), "a record goes on")


@dataclass
class Mcap:
    library: str = ""
    schemas: dict = field(default_factory=dict)  # id: (name, encoding, data)
    channels: dict = field(default_factory=dict)  # id: (schema id, topic, encoding)
    messages: dict = field(default_factory=dict)  # topic: [(log_time, publish_time, data)]
    metadata: dict = field(default_factory=dict)
    statistics: dict = field(default_factory=dict)
    chunks: int = 0
    order: list = field(default_factory=list)  # log times of all messages as they lie in the file


def records(data, begin, end):
    at = begin
    while at < end:
        require(at + 9 <= end, "a record's head is cut short")
        kind, length = struct.unpack_from("<BQ", data, at)
        require(at + 9 + length <= end, "a record is cut short")
        yield kind, at, data[at + 9:at + 9 + length]
        at += 9 + length
    require(at == end, "records do not end where they should")


def schema_of(content):
    fields = Fields(content)
    entry = fields.number("H"), (fields.text(), fields.text(), fields.take(fields.number("I")).decode())
    fields.end()
    require(entry[0] != 0, "a schema has the number 0")
    return entry


def channel_of(content):
    fields = Fields(content)
    entry = fields.number("H"), (fields.number("H"), fields.text(), fields.text())
    fields.map(Fields.text, Fields.text)
    fields.end()
    return entry


class Reader:
    def __init__(self, data):
        self.data, self.mcap = data, Mcap()
        self.chunk_places, self.sequence = [], {}
        require(data[:8] == MAGIC and data[-8:] == MAGIC, "the magic bytes are missing")

    def read(self):
        footer_at = len(self.data) - 8 - 29
        kind, length, summary, offsets, crc = struct.unpack_from("<BQQQI", self.data, footer_at)
        require((kind, length) == (FOOTER, 20), "the last record is no footer")
        require(zlib.crc32(self.data[summary:footer_at + 25]) == crc, "check sum of the summary")
        self.read_data(8, summary)
        self.read_summary(summary, offsets, footer_at)
        return self.mcap

    def read_data(self, begin, end):
        kinds = []
        for kind, at, content in records(self.data, begin, end):
            kinds.append(kind)
            fields = Fields(content)
            if kind == HEADER:
                require(at == begin, "a header in the middle")
                require(fields.text() == "", "an unknown profile")
                self.mcap.library = fields.text()
            elif kind == SCHEMA:
                self.mcap.schemas.update([schema_of(content)])
            elif kind == CHANNEL:
                number, channel = channel_of(content)
                require(channel[0] in self.mcap.schemas, "a channel before its schema")
                self.mcap.channels[number] = channel
            elif kind == METADATA:
                self.metadata_place = (at, 9 + len(content))
                name = fields.text()
                self.mcap.metadata[name] = fields.map(Fields.text, Fields.text)
            elif kind == CHUNK:
                self.read_chunk(at, content)
            elif kind == MESSAGE_INDEX:
                self.read_message_index(at, content)
            elif kind == DATA_END:
                require(fields.number("I") == zlib.crc32(self.data[:at]), "check sum of the data")
            else:
                raise Malformed(f"a record of kind {kind} among the data")
        require(kinds[0] == HEADER and kinds[-1] == DATA_END and kinds.count(DATA_END) == 1, "order of the records")

    def read_chunk(self, at, content):
        fields = Fields(content)
        first, last, size = fields.numbers("QQQ")
        crc, compression = fields.number("I"), fields.text()
        body = fields.take(fields.number("Q"))
        fields.end()
        require(compression == "" and len(body) == size and zlib.crc32(body) == crc, "a chunk's size or check sum")
        places, times = {}, []
        for kind, offset, message in records(body, 0, len(body)):
            require(kind == MESSAGE, "something other than messages in a chunk")
            number, sequence, log_time, publish_time = struct.unpack_from("<HIQQ", message)
            require(number in self.mcap.channels, "a message of a channel that is not known")
            require(sequence == self.sequence.setdefault(number, 0), "a message's sequence")
            self.sequence[number] += 1
            self.mcap.messages.setdefault(self.mcap.channels[number][1], []).append(
                (log_time, publish_time, message[22:]))
            places.setdefault(number, []).append((log_time, offset))
            times.append(log_time)
        require((first, last) == (min(times), max(times)), "a chunk's times")
        self.mcap.order += times
        self.mcap.chunks += 1
        self.chunk_places.append({"at": at, "length": 9 + len(content), "times": (first, last), "size": size,
                                  "places": places, "indices": {}, "indices_length": 0})

    def read_message_index(self, at, content):
        chunk, fields = self.chunk_places[-1], Fields(content)
        number = fields.number("H")
        inner = Fields(fields.take(fields.number("I")))
        fields.end()
        entries = []
        while inner.at < len(inner.content):
            entries.append((inner.number("Q"), inner.number("Q")))
        require(entries == chunk["places"][number] and number not in chunk["indices"], "an index of messages")
        chunk["indices"][number] = at
        chunk["indices_length"] += 9 + len(content)

    def read_summary(self, begin, offsets, end):
        groups, chunk_indices, schemas, channels = {}, [], {}, {}
        for kind, at, content in records(self.data, begin, offsets):
            first, length = groups.get(kind, (at, 0))
            require(first + length == at, "a summary that is not grouped")
            groups[kind] = (first, length + 9 + len(content))
            fields = Fields(content)
            if kind == SCHEMA:
                schemas.update([schema_of(content)])
            elif kind == CHANNEL:
                channels.update([channel_of(content)])
            elif kind == CHUNK_INDEX:
                chunk_indices.append(self.chunk_index_of(fields))
            elif kind == METADATA_INDEX:
                require(tuple(fields.numbers("QQ")) == self.metadata_place, "place of the metadata")
                require(fields.text() in self.mcap.metadata, "name of the metadata")
            elif kind == STATISTICS:
                self.read_statistics(fields)
            else:
                raise Malformed(f"a record of kind {kind} in the summary")
        require((schemas, channels) == (self.mcap.schemas, self.mcap.channels), "copies in the summary")
        require(len(chunk_indices) == len(self.chunk_places), "a chunk without an index")
        for chunk, index in zip(self.chunk_places, chunk_indices):
            require(set(chunk["indices"]) == set(chunk["places"]), "a channel without an index")
            require(index == [*chunk["times"], chunk["at"], chunk["length"], chunk["indices"],
                              chunk["indices_length"], "", chunk["size"], chunk["size"]], "an index of a chunk")
        told = {}
        for kind, _, content in records(self.data, offsets, end):
            require(kind == SUMMARY_OFFSET, "something other than offsets behind the summary")
            fields = Fields(content)
            group = fields.number("B")
            told[group] = tuple(fields.numbers("QQ"))
            fields.end()
        require(told == groups, "offsets of the summary")

    @staticmethod
    def chunk_index_of(fields):
        index = [*fields.numbers("QQQQ"), fields.map(lambda f: f.number("H"), lambda f: f.number("Q")),
                 fields.number("Q"), fields.text(), *fields.numbers("QQ")]
        fields.end()
        return index

    def read_statistics(self, fields):
        names = ("messages", "schemas", "channels", "attachments", "metadata", "chunks", "first", "last")
        told = dict(zip(names, fields.numbers("QHIIIIQQ")))
        counts = fields.map(lambda f: f.number("H"), lambda f: f.number("Q"))
        fields.end()
        mcap, times = self.mcap, self.mcap.order
        require(told == {"messages": len(times), "schemas": len(mcap.schemas), "channels": len(mcap.channels),
                         "attachments": 0, "metadata": len(mcap.metadata), "chunks": mcap.chunks,
                         "first": min(times), "last": max(times)}, "the statistics")
        topics = {mcap.channels[number][1]: count for number, count in counts.items()}
        require(topics == {channel[1]: len(mcap.messages.get(channel[1], [])) for channel in mcap.channels.values()},
                "the statistics' counts")
        mcap.statistics = told


def read(data):
    return Reader(data).read()

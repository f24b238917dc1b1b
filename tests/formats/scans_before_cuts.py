# SPDX-License-Identifier: MIT
"""How many scans a container cut at each hundredth of its length still holds.

scans_before_cuts.py FILE TOPIC

Prints 100 lines, one for each cut: how many messages of TOPIC lie before it as a whole, and how many
begin before it. Within chunks that are packed, the first counts chunks and not messages. Of an
SQLite bag both are what SQLite reads of the rows 1, 2, ... before it meets the damage.
Of a packed file (.zstd) the same is said of what its beginning unpacks to.
"""
import bz2
import itertools
import pathlib
import sqlite3
import struct
import sys
import tempfile

import lz4.frame
import zstandard

UNPACK = {"lz4": lz4.frame.decompress, "bz2": bz2.decompress,
          "zstd": lambda data: zstandard.ZstdDecompressor().decompressobj().decompress(data)}


def mcap_records(data, begin):
    at = begin
    while at + 9 <= len(data):
        op, size = struct.unpack_from("<BQ", data, at)
        yield op, at, data[at + 9:at + 9 + size]
        at += 9 + size
        if op == 0x02:  # footer
            return


def mcap_spans(content, topic):
    """Where messages of the topic begin and end; of packed chunks, where the chunk does."""
    own = set()

    def spans(data, begin, packed):
        for op, at, record in mcap_records(data, 0 if begin else 8):
            if op == 0x04:
                number, _, size = struct.unpack_from("<HHI", record)
                if record[8:8 + size].decode() == topic:
                    own.add(number)
            elif op == 0x05 and struct.unpack_from("<H", record)[0] in own:
                yield packed or (begin + at, begin + at + 9 + len(record))
            elif op == 0x06:
                size, = struct.unpack_from("<I", record, 28)
                inner = at + 9 + 32 + size + 8
                kind, stored = record[32:32 + size].decode(), record[40 + size:]
                if kind:
                    yield from spans(UNPACK[kind](stored), 1, (at, at + 9 + len(record)))
                else:
                    yield from spans(stored, inner, None)

    return list(spans(content, 0, None))


def bag_records(data, begin):
    at = begin
    while at < len(data):
        start = at
        size, = struct.unpack_from("<I", data, at)
        fields, field = {}, at + 4
        while field < at + 4 + size:
            length, = struct.unpack_from("<I", data, field)
            name, _, value = data[field + 4:field + 4 + length].partition(b"=")
            fields[name.decode()] = value
            field += 4 + length
        at += 4 + size
        size, = struct.unpack_from("<I", data, at)
        yield fields, start, at + 4, data[at + 4:at + 4 + size]
        at += 4 + size


def bag_spans(content, topic):
    own = set()

    def spans(data, first, begin, packed):
        for fields, start, at, inner in bag_records(data, first):
            op = fields["op"][0]
            if op == 0x07 and fields["topic"].decode() == topic:
                own.add(fields["conn"])
            elif op == 0x02 and fields["conn"] in own:
                yield packed or (begin + start, begin + at + len(inner))
            elif op == 0x05:
                kind = fields["compression"].decode()
                if kind == "none":
                    yield from spans(inner, 0, at, None)
                else:
                    yield from spans(UNPACK[kind](inner), 0, 0, (start, at + len(inner)))

    return list(spans(content, 13, 0, None))


def rows_read(path, topic):
    """Rows are asked for one by one: of a query for all, Python gives none it cannot read on from."""
    count = 0
    try:
        database = sqlite3.connect(f"file:{path}?mode=ro&immutable=1", uri=True)
        # Else SQLite reads nothing of a file that is shorter than it should be.
        database.execute("PRAGMA writable_schema=ON").fetchall()
        own = [number for number, in database.execute("SELECT id FROM topics WHERE name = ?", (topic,))]
        for number in itertools.count(1):
            row = database.execute("SELECT topic_id, data FROM messages WHERE id = ?", (number,)).fetchall()
            if not row:
                break
            count += row[0][0] in own
    except sqlite3.DatabaseError:
        pass
    return count


def sqlite_counts(content, sizes, topic):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "cut.db3"
        for size in sizes:
            path.write_bytes(content[:size])
            count = rows_read(path, topic)
            yield count, count


def counts(content, sizes, topic, name):
    if name.endswith(".zstd"):
        whole = UNPACK["zstd"](content)
        inner = [len(UNPACK["zstd"](content[:size])) if size else 0 for size in sizes]
        return counts(whole, inner, topic, name[:-5])
    if name.endswith(".db3"):
        return sqlite_counts(content, sizes, topic)
    spans = (bag_spans if name.endswith(".bag") else mcap_spans)(content, topic)
    return [(sum(end <= size for _, end in spans), sum(begin < size for begin, _ in spans)) for size in sizes]


def main():
    content = pathlib.Path(sys.argv[1]).read_bytes()
    sizes = [len(content) * percent // 100 for percent in range(100)]
    for whole, begun in counts(content, sizes, sys.argv[2], sys.argv[1]):
        print(whole, begun)


main()

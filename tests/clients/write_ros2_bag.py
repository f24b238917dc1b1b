# SPDX-License-Identifier: MIT
"""A folder of binary PCD scans as MCAP or as a ROS 2 bag, by the published layouts alone.

write_ros2_bag.py LOG_FOLDER OUT FORM

FORM of one file OUT: mcap-none, mcap-lz4, mcap-zstd (with chunks, summary and checksums),
mcap-unchunked (neither chunks nor summary), mcap-cut (the recorder was killed).
FORM of a folder OUT, split in three: db3, db3-file (each file packed), db3-message (each message
packed), mcap; the files are named so that their names are not in order of time, unless
metadata.yaml tells. A form that ends in -bare has no metadata.yaml.
"""
import pathlib
import sqlite3
import struct
import sys
import zlib

import lz4.frame
import zstandard

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from pcd_log import read_pcd, stamped_scans


class Cdr:
    """XCDR1, little-endian: offsets count from the byte after the first four."""

    def __init__(self):
        self.bytes = bytearray()

    def put(self, form, value):
        size = struct.calcsize("<" + form)
        self.bytes += b"\0" * (-len(self.bytes) % size) + struct.pack("<" + form, value)

    def text(self, value):
        self.put("I", len(value) + 1)
        self.bytes += value.encode() + b"\0"

    def whole(self):
        return b"\0\x01\0\0" + bytes(self.bytes)


def header(cdr, stamp):
    cdr.put("i", stamp // 10**9)
    cdr.put("I", stamp % 10**9)
    cdr.text("lidar")


def point_cloud2(path, stamp):
    data, count, fields = read_pcd(path)
    cdr = Cdr()
    header(cdr, stamp)
    cdr.put("I", 1)
    cdr.put("I", count)
    cdr.put("I", len(fields))
    for i, name in enumerate(fields):
        cdr.text(name)
        cdr.put("I", 4 * i)
        cdr.put("B", 7)
        cdr.put("I", 1)
    cdr.put("B", 0)
    cdr.put("I", 4 * len(fields))
    cdr.put("I", 4 * len(fields) * count)
    cdr.put("I", len(data))
    cdr.bytes += data
    cdr.put("B", 0)
    return cdr.whole()


def nav_sat_fix(stamp):
    cdr = Cdr()
    header(cdr, stamp)
    cdr.put("b", 0)
    cdr.put("H", 1)
    for value in [48.1, 11.6, 520.0] + 9 * [0.0]:
        cdr.put("d", value)
    cdr.put("B", 0)
    return cdr.whole()


TOPICS = [("/fix", "sensor_msgs/msg/NavSatFix"), ("/points", "sensor_msgs/msg/PointCloud2")]


def messages(scans):
    """(topic, time of recording, bytes)"""
    for path, stamp in scans:
        yield 0, stamp + 1000, nav_sat_fix(stamp)
        yield 1, stamp + 2000, point_cloud2(path, stamp)


def string(text):
    return struct.pack("<I", len(text)) + text.encode()


def record(op, content):
    return struct.pack("<BQ", op, len(content)) + content


class Mcap:
    """MCAP, version 0 of the specification."""

    magic = b"\x89MCAP0\r\n"

    def __init__(self, path, compression, chunk_bytes):
        self.file = open(path, "wb")
        self.compression = compression
        self.chunk_bytes = chunk_bytes  # none without chunks
        self.chunk, self.entries, self.chunk_indexes = bytearray(), [], []
        self.counts = [0, 0]
        self.times = []
        self.file.write(self.magic + record(0x01, string("ros2") + string("a test")))
        self.described = b"".join(
            record(0x03, struct.pack("<H", i + 1) + string(kind) + string("ros2msg") + string("# not needed"))
            + record(0x04, struct.pack("<HH", i, i + 1) + string(name) + string("cdr") + struct.pack("<I", 0))
            for i, (name, kind) in enumerate(TOPICS))
        if chunk_bytes is None:
            self.file.write(self.described)

    def message(self, topic, time, data):
        content = struct.pack("<HIQQ", topic, self.counts[topic], time, time) + data
        self.counts[topic] += 1
        self.times.append(time)
        if self.chunk_bytes is None:
            self.file.write(record(0x05, content))
            return
        if not self.chunk:
            self.chunk += self.described
        self.entries.append((topic, time, len(self.chunk)))
        self.chunk += record(0x05, content)
        if len(self.chunk) > self.chunk_bytes:
            self.end_chunk()

    def end_chunk(self):
        if not self.entries:
            return
        raw = bytes(self.chunk)
        packed = {"": lambda b: b, "lz4": lz4.frame.compress, "zstd": zstandard.compress}[self.compression](raw)
        first, last = min(e[1] for e in self.entries), max(e[1] for e in self.entries)
        offset = self.file.tell()
        self.file.write(record(0x06, struct.pack("<QQQI", first, last, len(raw), zlib.crc32(raw))
                               + string(self.compression) + struct.pack("<Q", len(packed)) + packed))
        length = self.file.tell() - offset
        places = b""
        for topic in sorted({e[0] for e in self.entries}):
            places += struct.pack("<HQ", topic, self.file.tell())
            pairs = b"".join(struct.pack("<QQ", time, at) for t, time, at in self.entries if t == topic)
            self.file.write(record(0x07, struct.pack("<HI", topic, len(pairs)) + pairs))
        self.chunk_indexes.append(record(0x08, struct.pack(
            "<QQQQI", first, last, offset, length, len(places)) + places + struct.pack(
                "<Q", self.file.tell() - offset - length) + string(self.compression)
            + struct.pack("<QQ", len(packed), len(raw))))
        self.chunk, self.entries = bytearray(), []

    def finish(self, summary=True):
        self.end_chunk()
        self.file.write(record(0x0F, struct.pack("<I", 0)))
        if not summary:
            self.file.write(record(0x02, struct.pack("<QQI", 0, 0, 0)) + self.magic)
            self.file.close()
            return
        start = self.file.tell()
        content = self.described + record(0x0B, struct.pack(
            "<QHIIIIQQI", sum(self.counts), 2, 2, 0, 0, len(self.chunk_indexes), min(self.times), max(self.times), 20)
            + b"".join(struct.pack("<HQ", i, n) for i, n in enumerate(self.counts)))
        content += b"".join(self.chunk_indexes)
        content += struct.pack("<BQQQ", 0x02, 20, start, 0)
        self.file.write(content + struct.pack("<I", zlib.crc32(content)) + self.magic)
        self.file.close()


def write_mcap(path, scans, form):
    compression = form if form in ("lz4", "zstd") else ""
    mcap = Mcap(path, compression, None if form == "unchunked" else 400_000)
    for message in messages(scans):
        mcap.message(*message)
    if form == "cut":
        mcap.end_chunk()
        mcap.file.close()
    else:
        mcap.finish(summary=form != "unchunked")


def write_db3(path, scans, pack):
    database = sqlite3.connect(path)
    database.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
                     "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)")
    database.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
                     "timestamp INTEGER NOT NULL, data BLOB NOT NULL)")
    database.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
    for i, (name, kind) in enumerate(TOPICS):
        database.execute("INSERT INTO topics VALUES(?, ?, ?, 'cdr', '')", (i + 1, name, kind))
    for topic, time, data in messages(scans):
        database.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)",
                         (topic + 1, time, pack(data)))
    database.commit()
    database.close()


def metadata(names, storage, mode, scans):
    lines = ["rosbag2_bagfile_information:", "  version: 5", f"  storage_identifier: {storage}",
             "  duration:", f"    nanoseconds: {scans[-1][1] - scans[0][1]}", "  starting_time:",
             f"    nanoseconds_since_epoch: {scans[0][1]}", f"  message_count: {2 * len(scans)}",
             "  topics_with_message_count:"]
    for name, kind in TOPICS:
        lines += ["    - topic_metadata:", f"        name: {name}", f"        type: {kind}",
                  "        serialization_format: cdr", '        offered_qos_profiles: ""',
                  f"      message_count: {len(scans)}"]
    lines += [f'  compression_format: "{"zstd" if mode else ""}"', f'  compression_mode: "{mode}"',
              "  relative_file_paths:"] + [f"    - {name}" for name in names]
    return "\n".join(lines) + "\n"


def write_folder(out, scans, form):
    out.mkdir()
    bare = form.endswith("-bare")
    form = form.removesuffix("-bare")
    storage, _, packed = form.partition("-")
    third = -(-len(scans) // 3)
    names = []
    for part, letter in enumerate("bca"):
        name = f"{letter}_{part}.{'mcap' if storage == 'mcap' else 'db3'}"
        own = scans[part * third:(part + 1) * third]
        if storage == "mcap":
            write_mcap(out / name, own, "zstd")
        else:
            write_db3(out / name, own, zstandard.compress if packed == "message" else lambda data: data)
        if packed == "file":
            whole = out / name
            (out / (name + ".zstd")).write_bytes(zstandard.compress(whole.read_bytes()))
            whole.unlink()
            name += ".zstd"
        names.append(name)
    if not bare:
        storage_name = "mcap" if storage == "mcap" else "sqlite3"
        mode = {"file": "FILE", "message": "MESSAGE"}.get(packed, "")
        (out / "metadata.yaml").write_text(metadata(names, storage_name, mode, scans))


def main():
    log, out, form = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3]
    scans = stamped_scans(log)
    if out.suffix == ".mcap":
        write_mcap(out, scans, form.partition("-")[2])
    else:
        write_folder(out, scans, form)


main()

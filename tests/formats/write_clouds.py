# SPDX-License-Identifier: MIT
"""Writes clouds for independent_writers_test.cpp with numpy: write_clouds.py FOLDER.

Point i of every cloud: x = 1 + i/2, y = -2 - i/4, z = i/8 (exact in binary), intensity i mod 200,
seen 0.1 ms * i after the start of the sweep. Each file lies in a folder of its own and is named by
its stamp 1600000000.25 s. cases.txt: NAME PATH START TOLERANCE, START = first offset in seconds or
"none" for clouds without times.
"""
import itertools
import pathlib
import struct
import sys

import numpy as np

N = 1000
STAMP_NS = 1_600_000_000_250_000_000
i = np.arange(N)
SINCE_START = i * 1e-4
COLUMNS = {"x": 1 + i / 2, "y": -2 - i / 4, "z": i / 8, "intensity": i % 200}

# name of the field, type, values, first offset, tolerance of the offsets
TIMES = {
    "none": None,
    "u32_ns": ("t", "u4", i * 100_000, 0.0, 1e-8),
    "f32_end": ("time", "f4", SINCE_START - 0.0999, -0.0999, 1e-7),
    "f64_absolute": ("timestamp", "f8", 1_600_000_000.25 + SINCE_START, 0.0, 3e-7),
    "f64_absolute_ns": ("timestamp", "f8", np.float64(STAMP_NS) + SINCE_START * 1e9, 0.0, 3e-7),
    "f64_absolute_us": ("timestamp", "f8", STAMP_NS / 1e3 + SINCE_START * 1e6, 0.0, 5e-7),
    "f64_absolute_ms": ("time_stamp", "f8", STAMP_NS / 1e6 + SINCE_START * 1e3, 0.0, 5e-7),
    "i32_ns": ("time_offset_ns", "i4", i * 100_000 - 50_000_000, -0.05, 1e-8),
    "f32_ms": ("offset_time", "f4", SINCE_START * 1e3, 0.0, 1e-6),
    "f32_us": ("ts", "f4", SINCE_START * 1e6, 0.0, 1e-6),
    "u64_absolute_ns": ("stamp", "u8", STAMP_NS + i * 100_000, 0.0, 1e-8),
}
ORDERS = [["x", "y", "z", "intensity", "T"], ["T", "intensity", "z", "y", "x"],
          ["y", "T", "x", "intensity", "z"]]
PLY_TYPES = {"f4": "float", "f8": "double", "u4": "uint", "i4": "int", "u8": "uint64", "u2": "ushort",
             "u1": "uchar"}


def table(order, time, xyz, byte_order, padding):
    """A structured array with the columns in order and unused bytes between them."""
    fields = []
    for name in order:
        if name == "T" and time is None:
            continue
        kind = time[1] if name == "T" else ("u1" if name == "intensity" else xyz)
        fields.append((time[0] if name == "T" else name, kind, time[2] if name == "T" else COLUMNS[name]))
        if padding:
            fields.append((f"pad{len(fields)}", "u1", np.full(N, 90)))
    array = np.zeros(N, dtype=[(n, byte_order + k) for n, k, _ in fields])
    for name, _, values in fields:
        array[name] = values
    return array


def pcd_header(array, encoding):
    kinds = [array.dtype[n] for n in array.dtype.names]
    names = [("_" if n.startswith("pad") else n) for n in array.dtype.names]
    letters = {"f": "F", "u": "U", "i": "I"}
    return "\n".join([
        "# .PCD v0.7 - Point Cloud Data file format", "VERSION 0.7", "FIELDS " + " ".join(names),
        "SIZE " + " ".join(str(k.itemsize) for k in kinds),
        "TYPE " + " ".join(letters[k.kind] for k in kinds), "COUNT " + " ".join("1" for _ in kinds),
        f"WIDTH {N // 10}", "HEIGHT 10", "VIEWPOINT 0 0 0 1 0 0 0", f"POINTS {N}",
        f"DATA {encoding}", ""]).encode()


def text_rows(array):
    return "".join(" ".join(repr(v.item()) for v in row) + "\n" for row in array).encode()


def lzf_literals(raw):
    return b"".join(bytes([len(raw[k:k + 32]) - 1]) + raw[k:k + 32] for k in range(0, len(raw), 32))


def pcd(array, encoding):
    if encoding == "ascii":
        return pcd_header(array, encoding) + text_rows(array)
    if encoding == "binary":
        return pcd_header(array, encoding) + array.tobytes()
    raw = b"".join(array[n].tobytes() for n in array.dtype.names)
    packed = lzf_literals(raw)
    return pcd_header(array, encoding) + struct.pack("<II", len(packed), len(raw)) + packed


def ply(array, encoding):
    lines = ["ply", f"format {encoding} 1.0", f"element vertex {N}"]
    for name in array.dtype.names:
        kind = array.dtype[name]
        lines.append(f"property {PLY_TYPES[kind.str[1:]]} {name}")
    head = ("\n".join(lines + ["end_header", ""])).encode()
    return head + (text_rows(array) if encoding == "ascii" else array.tobytes())


def main(folder):
    cases = []

    def write(name, extension, content, time):
        path = folder / name / f"1600000000_250000000.{extension}"
        path.parent.mkdir(parents=True)
        path.write_bytes(content)
        start, tolerance = (time[3], time[4]) if time else ("none", 0)
        cases.append(f"{name} {path} {start} {tolerance}")

    for (kind, time), (k, order), xyz in itertools.product(
            TIMES.items(), enumerate(ORDERS), ["f4", "f8"]):
        padding = k == 2
        little = table(order, time, xyz, "<", padding)
        for encoding in ["ascii", "binary", "binary_compressed"]:
            write(f"pcd_{encoding}_{kind}_{k}_{xyz}", "pcd", pcd(little, encoding), time)
        for encoding, byte_order in [("ascii", "<"), ("binary_little_endian", "<"),
                                     ("binary_big_endian", ">")]:
            array = table(order, time, xyz, byte_order, padding)
            write(f"ply_{encoding}_{kind}_{k}_{xyz}", "ply", ply(array, encoding), time)
    for columns in (4, 6):
        rows = np.zeros((N + 1, columns), dtype="<f4")[:N]
        for c, name in enumerate(["x", "y", "z", "intensity"]):
            rows[:, c] = COLUMNS[name]
        time = None
        if columns == 6:
            rows[:, 5] = SINCE_START - 0.05
            time = ("time", "f4", None, -0.05, 1e-7)
        write(f"bin_{columns}", "bin", rows.tobytes(), time)
    (folder / "cases.txt").write_text("\n".join(cases) + "\n")


main(pathlib.Path(sys.argv[1]))

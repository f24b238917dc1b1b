# SPDX-License-Identifier: MIT
"""A folder of binary PCD scans of float32 fields, for the writers of bags beside this file."""
import decimal
import pathlib


def read_pcd(path):
    """Bytes of the points, and how many points and which fields they are."""
    content = path.read_bytes()
    end = content.index(b"DATA binary\n") + len(b"DATA binary\n")
    head = dict(line.split(" ", 1) for line in content[:end].decode().splitlines() if not line.startswith("#"))
    count = int(head["POINTS"])
    fields = head["FIELDS"].split()
    return content[end:end + count * 4 * len(fields)], count, fields


def stamped_scans(log):
    """(path, stamp in ns) of each scan; stamps come from times.txt, else from the names."""
    log = pathlib.Path(log)
    folder = log / "scans" if (log / "scans").is_dir() else log
    scans = sorted(folder.glob("*.pcd"), key=lambda p: tuple(int(s) for s in p.stem.split("_")))
    times = log / "times.txt"
    if times.exists():
        exact = [decimal.Decimal(line) for line in times.read_text().split()]
        stamps = [int((t * 10**9).to_integral_value(decimal.ROUND_HALF_EVEN)) for t in exact]
    else:
        stamps = [int(a) * 10**9 + int(b) for a, b in (p.stem.split("_") for p in scans)]
    return list(zip(scans, stamps))

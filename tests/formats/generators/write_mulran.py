# SPDX-License-Identifier: MIT
"""MulRan: write_mulran.py FOLDER. Two whole sweeps of 64 x 1024, a cut one, an empty one, and the car's poses."""
import sys

import numpy as np

from truth import Truth, packed, returns

FIELDS = [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("intensity", "<f4")]
RECORDS = 64 * 1024
FIRST = 1_561_000_444_390_857_630


def sweep(truth, stamp, seen, count=RECORDS):
    """Column after column; only the records `seen` hold a return, the rest are zero."""
    points = returns(len(seen), stamp % 7)
    table = np.zeros((count, 4), np.float32)
    table[seen, :3] = points
    table[seen, 3] = np.arange(len(seen)) * 3
    truth.bytes(f"KAIST99/Ouster/{stamp}.bin", packed(FIELDS, table.T))
    times = None if count != RECORDS else (np.array(seen) // 64) / 1024 * 0.1
    truth.scan(stamp, "unknown|start", "no|unknown", "none" if times is None else "derived", points,
               np.arange(len(seen)) * 3, times, zero=count - len(seen))


def main():
    truth = Truth(sys.argv[1])
    truth.log("KAIST99", "mulran")
    # Names of 19 and 18 digits do not occur together; the order is that of the numbers.
    sweep(truth, FIRST, [0, 1, 63, 64, 130, 32768, 65535])
    sweep(truth, FIRST + 100_000_000, list(range(5, RECORDS, 1111)))
    sweep(truth, FIRST + 200_000_000, list(range(0, 5000, 50)), 5000)  # truncated, as KAIST01's last
    truth.bytes(f"KAIST99/Ouster/{FIRST + 300_000_000}.bin", b"")
    truth.refused()
    # The base in UTM: 10 m east while it turns to the left by 90 degrees.
    truth.text("KAIST99/global_pose.csv",
               f"{FIRST},1,0,0,351000.25,0,1,0,4026000.5,0,0,1,20\n"
               f"{FIRST + 100_000_000},0,-1,0,351010.25,1,0,0,4026000.5,0,0,1,20\n")
    truth.text("KAIST99/data_stamp.csv", f"{FIRST},ouster\n{FIRST + 100_000_000},ouster\n")


main()

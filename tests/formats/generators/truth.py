# SPDX-License-Identifier: MIT
"""What the generators beside this file know about the logs they write, for sheet_datasets_test.cpp.

truth.txt: a line "log PATH FORMAT" (PATH relative to the folder), then, for each scan,
    scan STAMP_NS INSTANT COMPENSATION TIMES ZERO NON_FINITE N
and N lines "x y z intensity time". A topic may follow the format. INSTANT, COMPENSATION and TIMES are
words of kissmap/cloud/scan.hpp; several that are right are joined by |. ZERO and NON_FINITE count the
returns to be dropped. Time is s since the stamp. Intensity and time are "-" where there is
none. Of logs cut into sweeps by a rule of the reader there is one "stream" instead, with times since
its STAMP_NS over all sweeps. "refused" is an entry of the log that holds no scan.
"""
import pathlib

import numpy as np


def returns(count, turn=0.0):
    """Points in all directions, 5 to 60 m away, below and above: float32, never zero."""
    k = np.arange(count)
    angle = 2.399963 * k + turn
    distance = 5 + (k * 7 % 111) / 2
    height = -2 + (k % 16) / 4
    return np.stack([distance * np.cos(angle), distance * np.sin(angle), height], 1).astype(np.float32)


class Truth:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.file = open(self.folder / "truth.txt", "w")

    def log(self, path, kind, topic=""):
        print("log", path, kind, topic, file=self.file)

    def scan(self, stamp_ns, instant, compensation, source, points, intensities=None, times=None,
             zero=0, non_finite=0, word="scan"):
        print(word, stamp_ns, instant, compensation, source, zero, non_finite, len(points), file=self.file)
        for i, point in enumerate(np.asarray(points, float)):
            row = ["%.9g" % v for v in point]
            row.append("-" if intensities is None else "%.9g" % intensities[i])
            row.append("-" if times is None else "%.12g" % times[i])
            print(*row, file=self.file)

    def stream(self, *args, **kwargs):
        self.scan(*args, word="stream", **kwargs)

    def refused(self):
        print("refused", file=self.file)

    def path(self, name):
        """A file of the folder, whose own folder exists from now on."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        return path

    def bytes(self, name, content):
        self.path(name).write_bytes(content)

    def text(self, name, content):
        self.path(name).write_text(content)


def packed(fields, columns):
    """Records without padding from a list of (name, little-endian type) and their columns."""
    table = np.zeros(len(columns[0]), dtype=fields)
    for (name, _), column in zip(fields, columns):
        table[name] = column
    return table.tobytes()

# SPDX-License-Identifier: MIT
"""Binary and ascii PCD v0.7, from the sheet."""
import numpy as np


def pcd(names, types, columns, encoding="binary"):
    """`types` are little-endian numpy types such as <f4; packed in the order of `names`."""
    table = np.zeros(len(columns[0]), dtype=list(zip(names, types)))
    for name, column in zip(names, columns):
        table[name] = column
    letters = {"f": "F", "u": "U", "i": "I"}
    header = ["# .PCD v0.7 - Point Cloud Data file format", "VERSION 0.7", "FIELDS " + " ".join(names),
              "SIZE " + " ".join(str(np.dtype(t).itemsize) for t in types),
              "TYPE " + " ".join(letters[np.dtype(t).kind] for t in types),
              "COUNT " + " ".join("1" for _ in types), f"WIDTH {len(table)}", "HEIGHT 1",
              "VIEWPOINT 0 0 0 1 0 0 0", f"POINTS {len(table)}", f"DATA {encoding}"]
    head = ("\n".join(header) + "\n").encode()
    if encoding == "binary":
        return head + table.tobytes()
    rows = (" ".join("nan" if np.isnan(v) else repr(v.item()) for v in row) for row in table)
    return head + ("\n".join(rows) + "\n").encode()

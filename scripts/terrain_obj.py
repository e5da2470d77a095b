#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A quantized-mesh tile as OBJ, flat, for pictures: terrain_obj.py TILE.terrain OUT.obj [WIDTH_M]"""
import gzip
import struct
import sys


def unsigned(data, at, count):
    return struct.unpack_from(f"<{count}H", data, at), at + 2 * count


def summed(deltas):
    total, values = 0, []
    for delta in deltas:
        total += (delta >> 1) ^ -(delta & 1)
        values.append(total)
    return values


def main():
    with gzip.open(sys.argv[1]) as file:
        data = file.read()
    width_m = float(sys.argv[3]) if len(sys.argv) > 3 else 100000.0
    low_m, high_m = struct.unpack_from("<ff", data, 24)
    (count,) = struct.unpack_from("<I", data, 88)
    at = 92
    arrays = []
    for _ in range(3):
        deltas, at = unsigned(data, at, count)
        arrays.append(summed(deltas))
    at += at % 2
    (triangles,) = struct.unpack_from("<I", data, at)
    codes, at = unsigned(data, at + 4, 3 * triangles)
    highest, corners = 0, []
    for code in codes:
        corners.append(highest - code + 1)
        highest += code == 0
    with open(sys.argv[2], "w", encoding="ascii") as out:
        for u, v, h in zip(*arrays):
            z = low_m + (high_m - low_m) * h / 32767
            out.write(f"v {u / 32767 * width_m:.3f} {v / 32767 * width_m:.3f} {z:.3f}\n")
        for t in range(triangles):
            out.write("f {} {} {}\n".format(*corners[3 * t:3 * t + 3]))


main()

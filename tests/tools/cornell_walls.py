#!/usr/bin/env python3
"""Ratio of irradiance to the reference on each wall of the Cornell box: Σa/Σr over the pixels of a wall.

    cornell_walls.py A.exr REFERENCE.exr [--layer bounce]

A mean ratio near 1 over the picture can hide a floor four times too bright and a ceiling ten times too dark. A.exr is
what `loom render --output bounce|indirect` wrote of either shipped Cornell box with its own camera, REFERENCE.exr what
`loom reference` wrote at the same size. Walls are told apart by the reference's layers `normal` and `depth`.
"""
import argparse
import math
import struct
import sys
import zlib

EYE = (2.78, 2.73, -8.0)  # of configs/scenes/make_cornell.py; the camera looks along +z, and +x is on its left
TANGENT = 12.5 / 35.0


def read_exr(path):
    """Width, height and the 32-bit float channels of a single-part scanline EXR with ZIP compression or none."""
    data = open(path, "rb").read()
    if data[:4] != b"\x76\x2f\x31\x01":
        sys.exit(f"{path}: not an EXR")
    at, header = 8, {}
    while data[at]:
        name_end = data.index(0, at)
        type_end = data.index(0, name_end + 1)
        size = struct.unpack_from("<i", data, type_end + 1)[0]
        header[data[at:name_end].decode()] = data[type_end + 5:type_end + 5 + size]
        at = type_end + 5 + size
    names, raw = [], header["channels"]
    k = 0
    while raw[k]:
        end = raw.index(0, k)
        if struct.unpack_from("<i", raw, end + 1)[0] != 2:
            sys.exit(f"{path}: channels are not 32-bit float")
        names.append(raw[k:end].decode())
        k = end + 17
    x0, y0, x1, y1 = struct.unpack("<4i", header["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    rows = {0: 1, 2: 1, 3: 16}[header["compression"][0]]
    blocks = (height + rows - 1) // rows
    channels = {name: [None] * height for name in names}
    for offset in struct.unpack_from(f"<{blocks}Q", data, at + 1):
        y, size = struct.unpack_from("<2i", data, offset)
        count = min(rows, y1 - y + 1)
        packed = data[offset + 8:offset + 8 + size]
        whole = 4 * width * len(names) * count
        if header["compression"][0] and size < whole:
            flat = bytearray(zlib.decompress(packed))
            for i in range(1, len(flat)):
                flat[i] = (flat[i - 1] + flat[i] - 128) & 255
            half = (len(flat) + 1) // 2
            packed = bytearray(len(flat))
            packed[0::2], packed[1::2] = flat[:half], flat[half:]
        for row in range(count):
            for c, name in enumerate(names):
                channels[name][y - y0 + row] = struct.unpack_from(f"<{width}f", packed,
                                                                  4 * width * (row * len(names) + c))
    return width, height, channels


def wall_of(normal, position):
    x, y, z = normal
    if y > 0.99 and position[1] < 0.05:
        return "floor"
    if y < -0.99:
        return "ceiling"
    if z < -0.99 and position[2] > 5.5:
        return "back"
    if x < -0.99 and position[0] > 5.4:
        return "left"
    if x > 0.99 and position[0] < 0.1:
        return "right"
    return "blocks"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("image")
    parser.add_argument("reference")
    parser.add_argument("--layer", default="bounce")
    arguments = parser.parse_args()
    width, height, image = read_exr(arguments.image)
    ref_width, ref_height, reference = read_exr(arguments.reference)
    if (width, height) != (ref_width, ref_height):
        sys.exit("the pictures differ in size")
    sums = {}
    for row in range(height):
        for column in range(width):
            normal = [reference[f"normal.{c}"][row][column] for c in "RGB"]
            if not any(normal):
                continue
            sx = TANGENT * (2 * (column + 0.5) / width - 1)
            sy = TANGENT * (1 - 2 * (row + 0.5) / height)
            scale = reference["depth.Z"][row][column] / math.sqrt(1 + sx * sx + sy * sy)
            position = (EYE[0] - scale * sx, EYE[1] + scale * sy, EYE[2] + scale)
            sum_a, sum_r = sums.get(wall_of(normal, position), (0.0, 0.0))
            a = sum(image[c][row][column] for c in "RGB")
            r = sum(reference[f"{arguments.layer}.{c}"][row][column] for c in "RGB")
            sums[wall_of(normal, position)] = (sum_a + a, sum_r + r)
    names = ["floor", "ceiling", "left", "right", "back", "blocks"]
    print("| " + " | ".join(names) + " |")
    print("| " + " | ".join(f"{sums[n][0] / sums[n][1]:.2f}" if n in sums else "–" for n in names) + " |")


if __name__ == "__main__":
    main()

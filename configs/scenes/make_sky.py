#!/usr/bin/env python3
"""Writes evening-sky.exr beside this script: a small sky with a low sun behind haze.

64×32 texels, equirectangular: its middle is towards −Z, its right towards +X, its top towards +Y. Above the horizon it
goes from a warm to a blue, below it is dim earth; a lobe exp(60·(cosγ−1)) stands around the sun, 25° high in the middle.
W/(m² sr), linear Rec.709. Uncompressed OpenEXR with half floats, written by hand: no library is needed.
"""
import math
import pathlib
import struct

WIDTH, HEIGHT = 64, 32
ELEVATION = math.radians(25)
SUN = (0, math.sin(ELEVATION), -math.cos(ELEVATION))
EARTH, HORIZON, ZENITH, GLOW = (.12, .1, .08), (.9, .75, .6), (.12, .28, .7), (30, 21, 12)


def direction(x, y):
    azimuth = 2 * math.pi * ((x + .5) / WIDTH - .5)
    polar = math.pi * (y + .5) / HEIGHT
    return math.sin(azimuth) * math.sin(polar), math.cos(polar), -math.cos(azimuth) * math.sin(polar)


def radiance(w):
    if w[1] < 0:
        return EARTH
    lobe = math.exp(60 * (sum(a * b for a, b in zip(w, SUN)) - 1))
    return [h + (z - h) * math.sqrt(w[1]) + g * lobe for h, z, g in zip(HORIZON, ZENITH, GLOW)]


def attribute(name, kind, value):
    return f"{name}\0{kind}\0".encode() + struct.pack("<i", len(value)) + value


def exr(rows):
    """rows: of (r, g, b), the first at the top."""
    height, width = len(rows), len(rows[0])
    half, channels = 1, b"".join(f"{c}\0".encode() + struct.pack("<iiii", 1, 0, 1, 1) for c in "BGR") + b"\0"
    window = struct.pack("<iiii", 0, 0, width - 1, height - 1)
    head = struct.pack("<ii", 20000630, 2)
    head += attribute("channels", "chlist", channels) + attribute("compression", "compression", b"\0")
    head += attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", window)
    head += attribute("lineOrder", "lineOrder", b"\0") + attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    head += attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0))
    head += attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + b"\0"
    line = 3 * 2 * half * width
    first = len(head) + 8 * height
    table = b"".join(struct.pack("<Q", first + y * (8 + line)) for y in range(height))
    body = b"".join(
        struct.pack("<ii", y, line) + b"".join(struct.pack(f"<{width}e", *(p[c] for p in row)) for c in (2, 1, 0))
        for y, row in enumerate(rows))
    return head + table + body


if __name__ == "__main__":
    picture = [[radiance(direction(x, y)) for x in range(WIDTH)] for y in range(HEIGHT)]
    pathlib.Path(__file__).with_name("evening-sky.exr").write_bytes(exr(picture))

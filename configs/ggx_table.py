#!/usr/bin/env python3
"""Writes shaders/interop/ggx.h: the directional albedo of a GGX surface as a table.

E(μ) = ∫ f_s(v,l) ⟨n,l⟩ dω by visible normals (Heitz 2018): the mean of F·G₂/G₁ over them. With Schlick's
F = F₀ + (F₉₀ − F₀)·c, c = (1 − ⟨v,h⟩)⁵, it is F₀·A + F₉₀·B, where A has the weight 1 − c and B the weight c.
"""
import math
import pathlib

SIDE = 16
RINGS, SECTORS = 512, 32  # points of the disc over which the mean is taken: its rim holds the steepest normals

HEAD = """// The share of light that a GGX surface reflects, as a table: configs/ggx_table.py writes this file.
#ifndef LOOM_INTEROP_GGX_H
#define LOOM_INTEROP_GGX_H
#include "interop/interop.h"
LOOM_INTEROP_BEGIN
// A and B of E(μ) = F₀·A + F₉₀·B (docs/specular.md); rows: √μ from 0 to 1, columns: roughness √α from 0 to 1.
#define GGX_TABLE_SIDE %d
#ifdef __cplusplus
inline constexpr float ggx_table[] = {
#else
const float ggx_table[] = float[](
#endif
%s
#ifdef __cplusplus
};
#else
);
#endif
LOOM_INTEROP_END
#endif
"""


def smith(cosine, alpha):
    return (math.sqrt(1 + alpha * alpha * (1 / (cosine * cosine) - 1)) - 1) / 2


def albedo(mu, alpha):
    """A and B."""
    mu = max(mu, 1e-3)
    a = b = 0.
    vx, vz = alpha * math.sqrt(1 - mu * mu), mu
    length = math.hypot(vx, vz)
    vx, vz = vx / length, vz / length
    for i in range(RINGS):
        r = math.sqrt((i + .5) / RINGS)
        for j in range(SECTORS):
            phi = 2 * math.pi * (j + .5) / SECTORS
            p, q = r * math.cos(phi), r * math.sin(phi)
            q = (1 - (1 + vz) / 2) * math.sqrt(1 - p * p) + (1 + vz) / 2 * q
            w = math.sqrt(max(0., 1 - p * p - q * q))
            # The basis about (vx, 0, vz): (0, 1, 0) and (−vz, 0, vx).
            h = (alpha * (-vz * q + vx * w), alpha * p, max(0., vx * q + vz * w))
            length = math.sqrt(h[0] ** 2 + h[1] ** 2 + h[2] ** 2)
            c = (h[0] * math.sqrt(1 - mu * mu) + h[2] * mu) / length
            out = 2 * c * h[2] / length - mu
            if out <= 0:
                continue
            weight = (1 + smith(mu, alpha)) / (1 + smith(mu, alpha) + smith(out, alpha))
            share = (1 - min(1., c)) ** 5
            a += weight * (1 - share)
            b += weight * share
    return a / (RINGS * SECTORS), b / (RINGS * SECTORS)


def main():
    rows = []
    for i in range(SIDE):
        row = [albedo((i / (SIDE - 1)) ** 2, max(j / (SIDE - 1), .03) ** 2) for j in range(SIDE)]
        for k in range(0, SIDE, 8):
            rows.append("  " + ", ".join(f"{a:.4f}f, {b:.4f}f" for a, b in row[k:k + 8]))
    root = pathlib.Path(__file__).parent.parent
    (root / "shaders/interop/ggx.h").write_text(HEAD % (SIDE, ",\n".join(rows)))


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Writes grey-room.gltf beside this script: a scene that needs little.

A closed room of 6 m × 3 m × 5 m with a block in it, everything of one grey of albedo .5, lit by one white spot under the
ceiling. Nothing moves, emits, is masked or has a texture.
"""
import pathlib

from make_cornell import CAMERA, DOWN, diffuse, mesh_data, text


def box(low, high, inwards):
    """Six quads, counter-clockwise seen from outside; from inside where `inwards`."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    quads = [[(x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1)], [(x0, y1, z0), (x0, y1, z1), (x1, y1, z1), (x1, y1, z0)],
             [(x0, y0, z0), (x0, y0, z1), (x0, y1, z1), (x0, y1, z0)], [(x1, y0, z0), (x1, y1, z0), (x1, y1, z1), (x1, y0, z1)],
             [(x0, y0, z0), (x0, y1, z0), (x1, y1, z0), (x1, y0, z0)], [(x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)]]
    return [quad[::-1] for quad in quads] if inwards else quads


MESHES = {"room": ("grey", box((0, 0, 0), (6, 3, 5), True)), "block": ("grey", box((3.4, 0, 1.2), (4.6, 1.1, 2.2), False))}
SPOT = {"name": "spot", "type": "spot", "intensity": 40.0, "spot": {"innerConeAngle": 0.4, "outerConeAngle": 0.9}}


def build():
    nodes = [{"name": name, "mesh": i} for i, name in enumerate(MESHES)]
    nodes.append({"name": "camera", "camera": 0, "translation": [3, 1.5, 4.9]})
    nodes.append({"name": "spot", "translation": [2.6, 2.9, 2.4], "rotation": DOWN,
                  "extensions": {"KHR_lights_punctual": {"light": 0}}})
    camera = {"name": "camera", "type": "perspective", "perspective": {**CAMERA["perspective"], "yfov": 0.9}}
    return {"asset": {"version": "2.0", "generator": "make_grey_room.py"}, "extensionsUsed": ["KHR_lights_punctual"],
            "extensions": {"KHR_lights_punctual": {"lights": [SPOT]}}, "scene": 0,
            "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes, "cameras": [camera],
            "materials": [diffuse("grey", (0.5, 0.5, 0.5))], **mesh_data(MESHES, ["grey"], 1)}


if __name__ == "__main__":
    (pathlib.Path(__file__).parent / "grey-room.gltf").write_text(text(build()))

#!/usr/bin/env python3
"""Writes cornell-box.gltf and cornell-box-emissive.gltf beside this script.

Geometry and camera: the measurements published by the Cornell University Program of Computer Graphics, in millimetres
there and here 1 unit = 100 mm, so that the box is 5.56 m wide. Colours: the published spectra under D65 as linear
Rec.709. The box is open towards the camera, which looks along +Z.
"""
import base64
import json
import math
import pathlib
import struct

QUADS = {  # name: (material, corners in mm, counter-clockwise seen from inside the box or outside a block)
    "floor": ("white", [[(552.8, 0, 0), (0, 0, 0), (0, 0, 559.2), (549.6, 0, 559.2)]]),
    "ceiling": ("white", [[(556, 548.8, 0), (556, 548.8, 559.2), (0, 548.8, 559.2), (0, 548.8, 0)]]),
    "back wall": ("white", [[(549.6, 0, 559.2), (0, 0, 559.2), (0, 548.8, 559.2), (556, 548.8, 559.2)]]),
    "right wall": ("green", [[(0, 0, 559.2), (0, 0, 0), (0, 548.8, 0), (0, 548.8, 559.2)]]),
    "left wall": ("red", [[(552.8, 0, 0), (549.6, 0, 559.2), (556, 548.8, 559.2), (556, 548.8, 0)]]),
    "short block": ("white", [
        [(130, 165, 65), (82, 165, 225), (240, 165, 272), (290, 165, 114)],
        [(290, 0, 114), (290, 165, 114), (240, 165, 272), (240, 0, 272)],
        [(130, 0, 65), (130, 165, 65), (290, 165, 114), (290, 0, 114)],
        [(82, 0, 225), (82, 165, 225), (130, 165, 65), (130, 0, 65)],
        [(240, 0, 272), (240, 165, 272), (82, 165, 225), (82, 0, 225)]]),
    "tall block": ("white", [
        [(423, 330, 247), (265, 330, 296), (314, 330, 456), (472, 330, 406)],
        [(423, 0, 247), (423, 330, 247), (472, 330, 406), (472, 0, 406)],
        [(472, 0, 406), (472, 330, 406), (314, 330, 456), (314, 0, 456)],
        [(314, 0, 456), (314, 330, 456), (265, 330, 296), (265, 0, 296)],
        [(265, 0, 296), (265, 330, 296), (423, 330, 247), (423, 0, 247)]]),
}
# Half a millimetre under the ceiling, so that the two do not fight for the depth.
LAMP = ("lamp", [[(343, 548.3, 227), (343, 548.3, 332), (213, 548.3, 332), (213, 548.3, 227)]])
COLORS = {"white": (0.738226, 0.735781, 0.740013), "red": (0.490093, 0.050404, 0.05105),
          "green": (0.06858, 0.398296, 0.086624), "lamp": (0.78, 0.78, 0.78)}
LAMP_RADIANCE = (20.621247, 10.906165, 2.761989)  # W/(m² sr): 400:0 500:8 600:15.6 700:18.4 nm
SPOT = {"name": "spot", "type": "spot", "intensity": 60.0,
        "spot": {"innerConeAngle": round(math.radians(25), 6), "outerConeAngle": round(math.radians(55), 6)}}


def mesh_data(meshes, names, scale):
    """Quads as meshes, accessors, buffer views and the buffer; `names`: of the materials, in order."""
    data, views, accessors, gltf_meshes = b"", [], [], []
    for name, (material, quads) in meshes.items():
        corners = [tuple(round(c * scale, 6) for c in corner) for quad in quads for corner in quad]
        indices = [4 * q + i for q in range(len(quads)) for i in (0, 1, 2, 0, 2, 3)]
        primitive = {"attributes": {"POSITION": len(accessors)}, "indices": len(accessors) + 1,
                     "material": names.index(material)}
        for target, kind, fmt, rows in ((34962, "VEC3", "<3f", corners), (34963, "SCALAR", "<1H", [(i,) for i in indices])):
            packed = b"".join(struct.pack(fmt, *row) for row in rows)
            views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(packed), "target": target})
            accessor = {"bufferView": len(views) - 1, "componentType": 5126 if kind == "VEC3" else 5123,
                        "count": len(rows), "type": kind}
            if kind == "VEC3":
                floats = [struct.unpack(fmt, struct.pack(fmt, *row)) for row in rows]
                accessor["min"] = [min(column) for column in zip(*floats)]
                accessor["max"] = [max(column) for column in zip(*floats)]
            accessors.append(accessor)
            data += packed + b"\0" * (-len(packed) % 4)
        gltf_meshes.append({"name": name, "primitives": [primitive]})
    return {"meshes": gltf_meshes, "accessors": accessors, "bufferViews": views,
            "buffers": [{"byteLength": len(data),
                         "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}]}


def diffuse(name, color):
    return {"name": name, "pbrMetallicRoughness": {
        "baseColorFactor": [*color, 1], "metallicFactor": 0, "roughnessFactor": 1}}


# 35 mm lens before 25 mm of film.
CAMERA = {"type": "perspective",
          "perspective": {"yfov": round(2 * math.atan(12.5 / 35), 6), "aspectRatio": 1, "znear": 0.01}}
HALF = round(math.sqrt(0.5), 9)
DOWN = [-HALF, 0, 0, HALF]  # a quarter turn about X: −Z, the way a light points, becomes −Y


def build(emissive):
    meshes = dict(QUADS)
    if emissive:
        meshes["lamp"] = LAMP
    names = ["white", "red", "green"] + (["lamp"] if emissive else [])
    materials = []
    for name in names:
        material = diffuse(name, COLORS[name])
        if name == "lamp":
            strength = max(LAMP_RADIANCE)
            material["emissiveFactor"] = [round(c / strength, 6) for c in LAMP_RADIANCE]
            material["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}
        materials.append(material)
    nodes = [{"name": name, "mesh": i} for i, name in enumerate(meshes)]
    # The node turns the camera to look along +Z.
    nodes.append({"name": "camera", "camera": 0, "translation": [2.78, 2.73, -8.0], "rotation": [0, 1, 0, 0]})
    document = {"asset": {"version": "2.0", "generator": "make_cornell.py",
                          "copyright": "Geometry and spectra: Cornell University Program of Computer Graphics"}}
    if emissive:
        document["extensionsUsed"] = ["KHR_materials_emissive_strength"]
    else:
        document["extensionsUsed"] = ["KHR_lights_punctual"]
        document["extensions"] = {"KHR_lights_punctual": {"lights": [SPOT]}}
        nodes.append({"name": "spot", "translation": [2.78, 5.4, 2.796], "rotation": DOWN,
                      "extensions": {"KHR_lights_punctual": {"light": 0}}})
    document.update({
        "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes,
        "cameras": [{"name": "published camera", **CAMERA}], "materials": materials,
        **mesh_data(meshes, names, 0.01)})
    return document


def text(document):
    """One line an element of the top-level arrays: short, and still readable."""
    lines = []
    for key, value in document.items():
        if isinstance(value, list) and value and isinstance(value[0], dict):
            rows = ",\n".join("    " + json.dumps(row, ensure_ascii=False) for row in value)
            lines.append(f'  "{key}": [\n{rows}\n  ]')
        else:
            lines.append(f'  "{key}": {json.dumps(value, ensure_ascii=False)}')
    return "{\n" + ",\n".join(lines) + "\n}\n"


if __name__ == "__main__":
    here = pathlib.Path(__file__).parent
    for file, emissive in (("cornell-box.gltf", False), ("cornell-box-emissive.gltf", True)):
        (here / file).write_text(text(build(emissive)))

#!/usr/bin/env python3
"""Writes cornell-box.gltf, cornell-box-emissive.gltf and cornell-box-balls.gltf beside this script.

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


# Of the gloss scene: (material, centre, radius) in mm.
BALLS = {"glass ball": ("glass", (186, 255.3, 169), 90), "metal ball": ("gold", (400, 85.3, 130), 85)}
RINGS, SECTORS = 24, 48


def ball(centre, radius):
    """A sphere as (points, normals, indices): 48 × 24 facets, whose vertices lie so that its volume is the sphere's to
    a thousandth; counter-clockwise from outside."""
    points, normals, indices = [], [], []
    for ring in range(RINGS + 1):
        theta = math.pi * ring / RINGS
        for sector in range(SECTORS + 1):
            phi = 2 * math.pi * sector / SECTORS
            n = (math.sin(theta) * math.cos(phi), math.cos(theta), -math.sin(theta) * math.sin(phi))
            normals.append(tuple(round(c, 6) + 0. for c in n))
            points.append(tuple(c + 1.0024 * radius * d for c, d in zip(centre, n)))
    for ring in range(RINGS):
        for sector in range(SECTORS):
            a = ring * (SECTORS + 1) + sector
            b = a + SECTORS + 1
            if ring > 0:
                indices += [a, b, a + 1]
            if ring < RINGS - 1:
                indices += [a + 1, b, b + 1]
    return points, normals, indices


def mesh_data(meshes, names, scale):
    """Quads and balls as meshes, accessors, buffer views and the buffer; `names`: of the materials, in order."""
    data, views, accessors, gltf_meshes = b"", [], [], []
    for name, (material, *shape) in meshes.items():
        normals = []
        if len(shape) == 1:
            points = [corner for quad in shape[0] for corner in quad]
            indices = [4 * q + i for q in range(len(shape[0])) for i in (0, 1, 2, 0, 2, 3)]
        else:
            points, normals, indices = ball(*shape)
        corners = [tuple(round(c * scale, 6) for c in corner) for corner in points]
        attributes = {"POSITION": len(accessors)}
        primitive = {"attributes": attributes, "indices": len(accessors) + 1, "material": names.index(material)}
        rows_of = [(34962, "VEC3", "<3f", corners), (34963, "SCALAR", "<1H", [(i,) for i in indices])]
        if normals:
            attributes["NORMAL"] = len(accessors) + 2
            rows_of.append((34962, "VEC3", "<3f", normals))
        for target, kind, fmt, rows in rows_of:
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


# Gold: reflectance along the normal, linear Rec.709. Varnish and glass: index of refraction 1.5, glTF's default.
GLOSSY = {
    "gold": {"pbrMetallicRoughness": {"baseColorFactor": [1.0, 0.766, 0.336, 1], "metallicFactor": 1, "roughnessFactor": 0.15}},
    "varnish": {"pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.5, 1], "metallicFactor": 0, "roughnessFactor": 0.3}},
    "glass": {"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1], "metallicFactor": 0, "roughnessFactor": 0},
              "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 1.5}}},
}


def build(emissive, gloss=False):
    meshes = dict(QUADS)
    if emissive:
        meshes["lamp"] = LAMP
    names = ["white", "red", "green"] + (["lamp"] if emissive else []) + (list(GLOSSY) if gloss else [])
    if gloss:
        meshes["tall block"] = ("varnish", meshes["tall block"][1])
        meshes.update({name: (material, centre, radius) for name, (material, centre, radius) in BALLS.items()})
    materials = []
    for name in names:
        material = {"name": name, **GLOSSY[name]} if name in GLOSSY else diffuse(name, COLORS[name])
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
    used = ["KHR_materials_emissive_strength"] if emissive else []
    used += ["KHR_materials_ior", "KHR_materials_transmission"] if gloss else []
    document["extensionsUsed"] = used + ([] if emissive and not gloss else ["KHR_lights_punctual"])
    if not emissive or gloss:
        light = {**SPOT, "intensity": 20.0} if gloss else SPOT
        document["extensions"] = {"KHR_lights_punctual": {"lights": [light]}}
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
    for file, *kind in (("cornell-box.gltf", False), ("cornell-box-emissive.gltf", True),
                        ("cornell-box-balls.gltf", True, True)):
        (here / file).write_text(text(build(*kind)))

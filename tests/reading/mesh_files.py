"""Meshes in every format that is read, written by hand, and hostile ones."""

from __future__ import annotations

import base64
import io
import json
import struct
import zipfile
from collections.abc import Sequence

import numpy as np

Rows = Sequence[Sequence[float]]

LOW, HIGH = (-0.1, -0.05, 0.0), (0.1, 0.05, 0.03)
CORNERS: Rows = [
    (x, y, z) for x in (LOW[0], HIGH[0]) for y in (LOW[1], HIGH[1]) for z in (LOW[2], HIGH[2])
]
FACES: Rows = [
    *((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)),
    *((2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),
]


def stl(corners: Rows = CORNERS, faces: Rows = FACES) -> bytes:
    rows = np.zeros(len(faces), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("end", "<u2")])
    rows["corners"] = np.array(corners)[np.array(faces, int)]
    return b"\0" * 80 + struct.pack("<I", len(faces)) + rows.tobytes()


def text_stl(corners: Rows = CORNERS, faces: Rows = FACES) -> bytes:
    rows = [
        "facet normal 0 0 0\nouter loop\n"
        + "".join("vertex {} {} {}\n".format(*corners[int(n)]) for n in face)
        + "endloop\nendfacet\n"
        for face in faces
    ]
    return f"solid box\n{''.join(rows)}endsolid box\n".encode()


def obj(before: str = "", corners: Rows = CORNERS, faces: Rows = FACES) -> bytes:
    rows = ["v {} {} {}".format(*corner) for corner in corners]
    rows += ["f {} {} {}".format(*(n + 1 for n in face)) for face in faces]
    return "\n".join([before, *rows, ""]).encode()


DAE = """<?xml version="1.0" encoding="utf-8"?>{before}
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="unit" meter="{unit}"/><up_axis>{up}</up_axis></asset>
<library_geometries><geometry id="box"><mesh>
<source id="p"><float_array id="pa" count="{count}">{numbers}</float_array>
<technique_common><accessor source="#pa" count="{corners}" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="{faces}"><input semantic="VERTEX" source="#v" offset="0"/><p>{indices}</p>
</triangles></mesh></geometry></library_geometries>{nodes}
<library_visual_scenes><visual_scene id="s">{scene}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
"""
BOX = '<instance_geometry url="#box"/>'


def dae(
    unit: float = 1.0,
    up: str = "Z_UP",
    before: str = "",
    nodes: str = "",
    scene: str = "",
    corners: Rows = CORNERS,
    faces: Rows = FACES,
) -> bytes:
    """Make COLLADA from corners in metres, with a prefix, nodes and a scene."""
    numbers = [number / unit for corner in corners for number in corner]
    text = DAE.format(
        before=before,
        unit=unit,
        up=up,
        count=len(numbers),
        numbers=" ".join(str(number) for number in numbers),
        corners=len(corners),
        faces=len(faces),
        indices=" ".join(str(n) for face in faces for n in face),
        nodes=nodes,
        scene=scene or f'<node id="n">{BOX}</node>',
    )
    return text.encode()


def gltf(
    uri: str = "",
    count: int = 0,
    placed: bool = True,
    corners: Rows = CORNERS,
    faces: Rows = FACES,
) -> dict[str, object]:
    """Make the JSON of glTF, whose buffer is in it, at another place, or the part of a GLB."""
    data = _buffer(corners, faces)
    if uri == "inside":
        uri = f"data:application/octet-stream;base64,{base64.b64encode(data).decode()}"
    size = 12 * len(corners)
    kinds = {"componentType": 5126, "count": count or len(corners), "type": "VEC3"}
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {**kinds, "bufferView": 0} if placed else kinds,
            {"bufferView": 1, "componentType": 5125, "count": 3 * len(faces), "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": size},
            {"buffer": 0, "byteOffset": size, "byteLength": len(data) - size},
        ],
        "buffers": [{"byteLength": len(data), **({"uri": uri} if uri else {})}],
    }


def glb(tree: dict[str, object], corners: Rows = CORNERS, faces: Rows = FACES) -> bytes:
    words = json.dumps(tree).encode()
    words += b" " * (-len(words) % 4)
    data = _buffer(corners, faces)
    parts = struct.pack("<II", len(words), 0x4E4F534A) + words
    parts += struct.pack("<II", len(data), 0x004E4942) + data
    return struct.pack("<III", 0x46546C67, 2, 12 + len(parts)) + parts


def _buffer(corners: Rows, faces: Rows) -> bytes:
    return np.array(corners, "<f4").tobytes() + np.array(faces, "<u4").tobytes()


def nested_nodes(levels: int) -> tuple[str, str]:
    """Return nodes that each contain the next one twice, and the scene with the first."""
    rows = [
        f'<node id="a{n}"><instance_node url="#a{n + 1}"/><instance_node url="#a{n + 1}"/></node>'
        for n in range(levels)
    ]
    last = f'<node id="a{levels}">{BOX}</node>'
    nodes = f"<library_nodes>{last}{''.join(reversed(rows))}</library_nodes>"
    return nodes, '<node id="n"><instance_node url="#a0"/></node>'


def zipped(data: bytes) -> bytes:
    """Pack a file with 50 MB of blanks after it."""
    file = io.BytesIO()
    with (
        zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive,
        archive.open("m.dae", "w") as part,
    ):
        part.write(data)
        for _ in range(50):
            part.write(b" " * 1_000_000)
    return file.getvalue()


ENTITIES = (
    '<!DOCTYPE a [<!ENTITY a "0 0 0 0 0 0 0 0 0 0">'
    + "".join(
        f'<!ENTITY {b} "{f"&{a};" * 10}">' for a, b in zip("abcdefgh", "bcdefghi", strict=True)
    )
    + "]>"
)

BOXES = {
    "binary.stl": stl(),
    "text.stl": text_stl(),
    "box.obj": obj(),
    "metres.dae": dae(),
    "millimetres.dae": dae(unit=0.001),
    "y_up.dae": dae(up="Y_UP"),
    "box.glb": glb(gltf()),
    "box.gltf": json.dumps(gltf("inside")).encode(),
}
"""By name; all of them are the same box."""

_NODES, _SCENE = nested_nodes(40)
HOSTILE = {
    "entities.dae": dae(before=ENTITIES).replace(b"0.1 ", b"&i; "),
    "external.dae": dae(before='<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]>'),
    "nodes.dae": dae(nodes=_NODES, scene=_SCENE),
    "zip.dae": zipped(dae()),
    "deep.dae": dae(scene="<node>" * 5000 + "</node>" * 5000),
    "unit.dae": dae().replace(b'meter="1.0"', b'meter="0"'),
    "count.glb": glb(gltf(count=2**40)),
    "zeros.glb": glb(gltf(count=2**31, placed=False)),
    "far.gltf": json.dumps(gltf("../../etc/passwd")).encode(),
    "web.gltf": json.dumps(gltf("http://localhost:9/b.bin")).encode(),
    "faces.stl": b"\0" * 80 + struct.pack("<I", 2**32 - 1) + b"\0" * 50,
    "indices.obj": obj().replace(b"f 1 2 4", b"f 1 2 999999999"),
    "empty.stl": b"",
    "empty.dae": b"",
    "empty.glb": b"",
}
"""By name; none of them may take much, open anything, or be taken for a mesh."""

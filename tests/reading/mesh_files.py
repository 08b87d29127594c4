"""Meshes of a box in every format that is read, made by hand or by trimesh, and hostile ones."""

from __future__ import annotations

import base64
import io
import json
import struct
import zipfile

import numpy as np

LOW, HIGH = (-0.1, -0.05, 0.0), (0.1, 0.05, 0.03)
CORNERS = [
    (x, y, z) for x in (LOW[0], HIGH[0]) for y in (LOW[1], HIGH[1]) for z in (LOW[2], HIGH[2])
]
FACES = [
    *((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)),
    *((2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),
]


def stl() -> bytes:
    facets = b"".join(
        struct.pack("<12fH", 0, 0, 0, *CORNERS[a], *CORNERS[b], *CORNERS[c], 0) for a, b, c in FACES
    )
    return b"\0" * 80 + struct.pack("<I", len(FACES)) + facets


def text_stl() -> bytes:
    rows = [
        "facet normal 0 0 0\nouter loop\n"
        + "".join("vertex {} {} {}\n".format(*CORNERS[n]) for n in face)
        + "endloop\nendfacet\n"
        for face in FACES
    ]
    return f"solid box\n{''.join(rows)}endsolid box\n".encode()


def obj(before: str = "") -> bytes:
    rows = ["v {} {} {}".format(*corner) for corner in CORNERS]
    rows += ["f {} {} {}".format(*(n + 1 for n in face)) for face in FACES]
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
    unit: float = 1.0, up: str = "Z_UP", before: str = "", nodes: str = "", scene: str = ""
) -> bytes:
    """Make COLLADA; of a box in metres whose node may be anything."""
    numbers = [number / unit for corner in CORNERS for number in corner]
    text = DAE.format(
        before=before,
        unit=unit,
        up=up,
        count=len(numbers),
        numbers=" ".join(str(number) for number in numbers),
        corners=len(CORNERS),
        faces=len(FACES),
        indices=" ".join(str(n) for face in FACES for n in face),
        nodes=nodes,
        scene=scene or f'<node id="n">{BOX}</node>',
    )
    return text.encode()


def gltf(uri: str = "", count: int = len(CORNERS), view: int = 0) -> dict[str, object]:
    """Make the JSON of glTF, whose buffer is in it, at another place, or the part of a GLB."""
    data = _buffer()
    if uri == "inside":
        uri = f"data:application/octet-stream;base64,{base64.b64encode(data).decode()}"
    size = 12 * len(CORNERS)
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {
                **({"bufferView": 0} if view == 0 else {}),
                "componentType": 5126,
                "count": count,
                "type": "VEC3",
                "min": LOW,
                "max": HIGH,
            },
            {"bufferView": 1, "componentType": 5125, "count": 3 * len(FACES), "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": size},
            {"buffer": 0, "byteOffset": size, "byteLength": len(data) - size},
        ],
        "buffers": [{"byteLength": len(data), **({"uri": uri} if uri else {})}],
    }


def glb(tree: dict[str, object] | None = None) -> bytes:
    words = json.dumps(gltf() if tree is None else tree).encode()
    words += b" " * (-len(words) % 4)
    data = _buffer()
    parts = struct.pack("<II", len(words), 0x4E4F534A) + words
    parts += struct.pack("<II", len(data), 0x004E4942) + data
    return struct.pack("<III", 0x46546C67, 2, 12 + len(parts)) + parts


def _buffer() -> bytes:
    return np.array(CORNERS, "<f4").tobytes() + np.array(FACES, "<u4").tobytes()


def nested_nodes(levels: int) -> tuple[str, str]:
    """Return nodes, each of which has the next one twice, and the scene that has the first."""
    rows = [
        f'<node id="a{n}"><instance_node url="#a{n + 1}"/><instance_node url="#a{n + 1}"/></node>'
        for n in range(levels)
    ]
    last = f'<node id="a{levels}">{BOX}</node>'
    nodes = f"<library_nodes>{last}{''.join(reversed(rows))}</library_nodes>"
    return nodes, '<node id="n"><instance_node url="#a0"/></node>'


def zipped(data: bytes, size: int = 0) -> bytes:
    """Pack a file, with so many zeros beside it."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("m.dae", data + b" " * size)
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
    "box.glb": glb(),
    "box.gltf": json.dumps(gltf("inside")).encode(),
}
"""By name; all of them are the same box."""

_NODES, _SCENE = nested_nodes(40)
HOSTILE = {
    "entities.dae": dae(before=ENTITIES).replace(b"0.1 ", b"&i; "),
    "external.dae": dae(before='<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]>'),
    "nodes.dae": dae(nodes=_NODES, scene=_SCENE),
    "zip.dae": zipped(dae(), 300_000_000),
    "deep.dae": dae(scene="<node>" * 5000 + "</node>" * 5000),
    "count.glb": glb(gltf(count=2**40)),
    "zeros.glb": glb(gltf(count=2**31, view=-1)),
    "far.gltf": json.dumps(gltf("../../etc/passwd")).encode(),
    "web.gltf": json.dumps(gltf("http://localhost:9/b.bin")).encode(),
    "faces.stl": b"\0" * 80 + struct.pack("<I", 2**32 - 1) + b"\0" * 50,
    "indices.obj": obj().replace(b"f 1 2 4", b"f 1 2 999999999"),
    "empty.stl": b"",
    "empty.dae": b"",
    "empty.glb": b"",
}
"""By name; none of them may take much, open anything, or be taken for a mesh."""

"""Model files with faults: shipped and written ones, with bytes, numbers, tags, lines changed.

Where one names a file, a fault may name another in its place, such as a pipe or a device.
"""

from __future__ import annotations

import dataclasses
import json
import math
import random
import re
import struct
import zlib
from collections.abc import Callable, Sequence
from typing import Any

import crawler2d as c2d
from crawler2d.common.bodies import Disc
from crawler2d.parameters.track import Track
from tests.reading import carts, mesh_files
from tests.reading.odd_files import ODD
from tests.robots.robot_files import FOLDER

CARTS = carts.FILES


def _written(track: Track, form: str, discs: Sequence[Disc] | None = None) -> bytes:
    """A robot as a model file without its comment, which is not read."""
    robot = c2d.robots.engineer(track=track)
    if discs is not None:
        outline = c2d.TrackOutline(
            discs=discs, grouser_height=0.0, grouser_pitch=0.05, grouser_thickness=0.0
        )
        robot = dataclasses.replace(robot, outline=outline)
    text: str = getattr(robot, f"to_{form}")()
    return re.sub("<!--.*?-->", "", text, flags=re.DOTALL).encode()


GEARS = c2d.LineOfWheels(3, wheel=c2d.GearWheel(grouser_count=6))
TAPERED = c2d.LineOfWheels(2, wheel=c2d.GearWheel(grouser_count=5, base_thickness=0.012))
TRIANGLE = ((-0.18, 0.0, 0.064), (0.18, 0.0, 0.064), (0.25, 0.1, 0.05))

RING = [(0.08 * math.cos(a / 12 * math.tau), 0.08 * math.sin(a / 12 * math.tau)) for a in range(12)]
RIM = [[(x, y, z) for z in (-0.025, 0.025) for x, y in RING][n] for n in range(24)]
"""Corners of a prism that is a wheel [m]."""

TRIANGLES = [
    *[(n, (n + 1) % 12, 12 + n) for n in range(12)],
    *[(12 + n, n, 12 + (n + 1) % 12) for n in range(12)],
    *[(0, n, n + 1) for n in range(1, 11)],
    *[(12, 12 + n, 13 + n) for n in range(1, 11)],
]


_SOLID: dict[str, Any] = {"corners": RIM, "faces": TRIANGLES}
_PICTURE = '<library_images><image id="i"><init_from>part.png</init_from></image></library_images>'
MESHES = {
    "part.stl": mesh_files.text_stl(**_SOLID),
    "binary.stl": mesh_files.stl(**_SOLID),
    "part.obj": mesh_files.obj("mtllib part.obj", **_SOLID),
    "part.dae": mesh_files.dae(nodes=_PICTURE, **_SOLID),
    "part.glb": mesh_files.glb(mesh_files.gltf(**_SOLID), **_SOLID),
    "part.gltf": json.dumps(mesh_files.gltf("inside", **_SOLID)).encode(),
}
"""A wheel as a mesh, in each form."""

CHUNK = struct.Struct(">I4s")


def _chunk(kind: bytes, data: bytes) -> bytes:
    return CHUNK.pack(len(data), kind) + data + struct.pack(">I", zlib.crc32(kind + data))


PARTS = {
    **MESHES,
    "wheels.xacro": f"{carts.XACRO}{carts.WHEELS}</robot>".encode(),
    "any/urdf/wheels.xacro": f"{carts.XACRO}{carts.WHEELS}</robot>".encode(),
    "masses.yaml": b"hull: 8\nothers: [1, 2.5]\n",
    "settings.yaml": b"# sizes\nhull_mass: 8 # [kg]\nload: '0'\nboxes:\n  first: 1\nlist: [1, 2]\n",
    "part.png": b"\x89PNG\r\n\x1a\n"
    + _chunk(b"IHDR", struct.pack(">IIBBBBB", 4, 4, 8, 0, 0, 0, 0))
    + _chunk(b"IDAT", zlib.compress(b"\0\x10\x20\x30\x40" * 4))
    + _chunk(b"IEND", b""),
}
"""Files that models name."""

_ROUND = '<mesh filename="{}"/>'
_WHEELS = carts.pair("front", 0.2, geometry=_ROUND) + carts.pair("rear", -0.2, geometry=_ROUND)
ON_MESHES = {name: carts.urdf(_WHEELS.format(*[name] * 4)).encode() for name in MESHES}
"""By mesh, a cart that has it for its wheels."""


def _changed(name: str, old: str, new: str) -> bytes:
    text = (CARTS / name).read_text(encoding="utf-8")
    assert old in text
    return text.replace(old, new, 1).encode()


SDF: dict[str, bytes] = {
    **{
        path.name: path.read_bytes()
        for path in (
            FOLDER / "absolem.sdf",
            FOLDER / "marv.sdf",
            FOLDER / "tracked_vehicle_simple.sdf",
            CARTS / "cart.sdf",
        )
    },
    "belt.sdf": _written(c2d.BeltTrack(), "sdf", TRIANGLE),
    "gears.sdf": _written(GEARS, "sdf"),
    "odd.sdf": _changed(
        "cart.sdf",
        "</model>",
        """<include><uri>model://lidar</uri><name>lidar</name></include>
        <frame name="top"><pose>0 0 0.3 0 0 0</pose></frame>
        <model name="mast"><pose relative_to="top">0 0 0.1 0 0 0</pose>
        <link name="a"><inertial auto="true"><density>900</density></inertial>
        <collision name="c"><geometry><capsule><radius>0.02</radius><length>0.1</length></capsule>
        </geometry></collision></link>
        <link name="b"><pose relative_to="a">0 0 0.1 0 0 0</pose>
        <collision name="c"><geometry><ellipsoid><radii>0.1 0.1 0.05</radii></ellipsoid></geometry>
        </collision></link>
        <joint name="j" type="revolute"><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz>
        <limit><lower>-1</lower><upper>1</upper></limit></axis></joint></model>
        <link name="stray"/>
        <joint name="m" type="fixed"><parent>hull</parent><child>mast::a</child></joint>
        <joint name="l" type="fixed"><parent>hull</parent><child>lidar::base</child></joint>
        <joint name="w" type="fixed"><parent>world</parent><child>hull</child></joint></model>""",
    ),
    "mesh.sdf": _changed(
        "cart.sdf", "<box><size>0.5 0.25 0.125</size></box>", "<mesh><uri>part.stl</uri></mesh>"
    ),
}
"""By name; of the small ones, a fault hits what matters more often."""

URDF = {
    "eng.urdf": (FOLDER / "eng.urdf").read_bytes(),
    "cart.urdf": (CARTS / "cart.urdf").read_bytes(),
    "gears.urdf": _written(GEARS, "urdf"),
    "mesh.urdf": ON_MESHES["part.obj"],
    "odd.urdf": carts.urdf(
        carts.WHEELS,
        '<link name="world"/><joint name="w" type="fixed"><parent link="world"/>'
        '<child link="hull"/></joint><link name="stray"><inertial><mass value="1e-5"/>'
        '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>',
        carts.link("head", 'type="revolute"><axis xyz="0 0 0"/><limit lower="0" upper="0"/>'),
        shapes=carts.collision('<sphere radius="0"/>') + carts.collision("<plane/>"),
    ).encode(),
}


def _with_gaps() -> bytes:
    """Old xacro with missing files, packages, macros and arguments, which are left out."""
    parts = """
<property name="low" value="0.001"/>
<xacro:include filename="lost.xacro"/>
<xacro:include filename="$(find nowhere)/urdf/lost.xacro"/>
<include filename="$(find parts)/urdf/wheels.xacro"/>
<xacro:sensor name="lidar"><origin xyz="0 0 ${missing}"/></xacro:sensor>
<if value="$(arg load)"><xacro:cargo mass="1"/></if>
<xacro:late/>
<macro name="box_of" params="size *where"><collision><xacro:insert_block name="where"/>
  <geometry><box size="${size} ${size} ${low}"/></geometry></collision></macro>
<link name="plate"><box_of size="0.1"><origin xyz="0 0 0.1"/></box_of></link>
<joint name="fix" type="fixed"><parent link="hull"/><child link="plate"/></joint>
<joint name="mount" type="fixed"><parent link="hull"/><child link="lidar"/></joint>
<xacro:macro name="late"><xacro:property name="done" value="1"/></xacro:macro>
"""
    text = carts.urdf(parts, mass="${$(arg hull_mass) + 0}")
    return text.replace('<robot name="cart">', carts.XACRO).encode()


MJCF = {
    "cart.xml": (CARTS / "cart.xml").read_bytes(),
    "belt.xml": _written(c2d.BeltTrack(), "mjcf", TRIANGLE),
    "gears.xml": _written(GEARS, "mjcf"),
    "tapered.xml": _written(TAPERED, "mjcf"),
    "assets.xml": _changed(
        "cart.xml",
        "<worldbody>",
        """<asset><mesh name="m" file="part.stl"/><mesh name="n" file="part.obj"/>
        <texture name="t" type="2d" file="part.png"/><texture name="c" type="cube"
        fileright="part.png"/><hfield name="h" file="part.png" size="1 1 0.1 0.1"/></asset>
        <worldbody><geom type="mesh" mesh="n" contype="0" conaffinity="0"/>""",
    ),
}
XACRO = {
    **{path.name: path.read_bytes() for path in (FOLDER / "eng.xacro", CARTS / "cart.xacro")},
    "parts.xacro": carts.urdf('<xacro:include filename="wheels.xacro"/>', mass="${m['hull']}")
    .replace(
        '<robot name="cart">',
        f'{carts.XACRO}<xacro:property name="m" value="${{xacro.load_yaml(\'masses.yaml\')}}"/>',
    )
    .encode(),
    "gaps.xacro": _with_gaps(),
}

NUMBERS = (
    *b"nan inf -inf 1e999 -1 0 -0.0 1e-320 1e300 999999 0x10 1_0 1,5 -1e6 3.1415".split(),
    *("\u0661".encode(), b"", b"1 2", b"9" * 70, b"1e-9"),
)

_NUMBER = re.compile(rb"-?\d+\.?\d*(?:e[+-]?\d+)?")
_TAG = re.compile(rb"</?[A-Za-z_:]+")
_FILE = re.compile(rb"(?<=[\"'>])[\w./:$() -]+\.(?:stl|obj|dae|glb|png|yaml|xacro)(?=[\"'<])")
_WORD = re.compile(rb"(?<=[>\"'])[A-Za-z_]\w+(?=[<\"'])")

ELSEWHERE = {
    "scheme": ("file:///dev/zero", "file://zero.stl", "package://p/pipe.obj", "model://m/a.stl"),
    "place": ("/dev/zero", "../part.stl", "/proc/self/mem", "/proc/kmsg", ".", "/", "no.stl"),
    "part": tuple(PARTS),
}
"""Names that a fault may give a file, beside those of what is none."""

Fault = Callable[[bytes, random.Random], bytes]


def mutated(data: bytes, draw: random.Random) -> bytes:
    """Put one to four faults into a file."""
    for _ in range(draw.choice((1, 1, 2, 4))):
        data = draw.choice(_FAULTS)(data, draw)
    return data


def _of_a_byte(data: bytes, draw: random.Random) -> bytes:
    where = draw.randrange(len(data) + 1)
    return data[:where] + bytes([draw.randrange(256)]) + data[where + draw.randrange(2) :]


def _of_a_number(data: bytes, draw: random.Random) -> bytes:
    return _swapped(_NUMBER, data, draw, draw.choice(NUMBERS))


def _of_a_tag(data: bytes, draw: random.Random) -> bytes:
    tags = _TAG.findall(data)
    return _swapped(_TAG, data, draw, draw.choice(tags)) if tags else data


def _of_a_name(data: bytes, draw: random.Random) -> bytes:
    words = _WORD.findall(data)
    return _swapped(_WORD, data, draw, draw.choice(words)) if words else data


def _of_a_file(data: bytes, draw: random.Random) -> bytes:
    named = _FILE.findall(data)
    if not named:
        return _of_a_number(data, draw)
    suffix = draw.choice([*named, b"a.stl", b"a.obj"]).rpartition(b".")[2].decode()
    name = draw.choice([*ODD, *ELSEWHERE])
    new = draw.choice(ELSEWHERE[name]) if name in ELSEWHERE else f"{name}.{suffix}"
    return _swapped(_FILE, data, draw, new.encode())


def _swapped(pattern: re.Pattern[bytes], data: bytes, draw: random.Random, new: bytes) -> bytes:
    found = list(pattern.finditer(data))
    if not found:
        return data
    spot = draw.choice(found)
    return data[: spot.start()] + new + data[spot.end() :]


def _without_lines(data: bytes, draw: random.Random) -> bytes:
    lines = data.split(b"\n")
    first = draw.randrange(len(lines))
    return b"\n".join(lines[:first] + lines[first + draw.choice((1, 1, 3, 30)) :])


def _with_lines_twice(data: bytes, draw: random.Random) -> bytes:
    lines = data.split(b"\n")
    first = draw.randrange(len(lines))
    some = lines[first : first + draw.choice((1, 5, 60))]
    return b"\n".join(lines[:first] + some * draw.choice((2, 2, 2, 50)) + lines[first:])


def _cut_short(data: bytes, draw: random.Random) -> bytes:
    return data[: draw.randrange(len(data) + 1)]


_FAULTS: tuple[Fault, ...] = (
    _of_a_byte,
    _of_a_number,
    _of_a_number,
    _of_a_tag,
    _of_a_name,
    _of_a_file,
    _without_lines,
    _with_lines_twice,
    _cut_short,
)

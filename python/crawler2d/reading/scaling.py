"""Model files in another unit of length: every length is multiplied in the text, before it is read.

So the lines stay those of the file, and a changed file is written in metres.
"""

from __future__ import annotations

from crawler2d.errors import ScenarioError
from crawler2d.writing.document import Document
from crawler2d.writing.spans import Span

__all__ = ["scaled"]

_SIZES = {
    "box": ("size",),
    "capsule": ("radius", "length"),
    "cone": ("radius", "length"),
    "cylinder": ("radius", "length"),
    "ellipsoid": ("radii",),
    "heightmap": ("size", "pos"),
    "mesh": ("scale",),
    "plane": ("size",),
    "polyline": ("point", "height"),
    "sphere": ("radius",),
}
"""What has lengths in a shape, as attributes in URDF, as elements in SDF."""

_INERTIA = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_SLIDE = ("lower", "upper", "velocity")


def scaled(data: bytes, scale: float, file: str) -> bytes:
    """Multiply the lengths of an SDF or URDF text.

    Places, sizes and limits of slides by the scale, moments of inertia by its square. Masses,
    torques and settings of plugins and sensors stay what they are.

    Parameters
    ----------
    data : bytes
        The text, which has been parsed.
    scale : float
        [-] Such as 0.001 for a file in millimetres.
    file : str
        Its name, for errors.

    Raises
    ------
    ScenarioError
        If the text is not in UTF-8.
    """
    try:
        document = Document(data.decode("utf-8"))
    except UnicodeDecodeError:
        raise ScenarioError(file, "another encoding", "must be UTF-8, to be scaled") from None
    for span in document.root.within():
        _scale(document, span, scale)
    return document.text.encode()


def _scale(document: Document, span: Span, scale: float) -> None:
    by = (scale,) * 3
    if span.tag == "pose" and not span.children:  # of a joint's limits and plugins, too
        document.multiply(span, by)
    elif span.tag == "origin":
        document.multiply(span, by, "xyz")
    elif span.tag in _SIZES:
        if span.tag == "mesh" and "scale" not in span.attributes and not span.only("scale"):
            _add_scale(document, span, scale)
        for name in _SIZES[span.tag]:
            document.multiply(span, by, name)
            for inner in span.all(name):
                document.multiply(inner, by)
    elif span.tag == "inertia":
        for name in _INERTIA:
            document.multiply(span, (scale**2,), name, is_exact=True)
            document.multiply(span.only(name), (scale**2,), is_exact=True)
    elif span.tag == "limit" and _is_of_slide(span):
        for name in _SLIDE:
            document.multiply(span, (scale,), name)
            document.multiply(span.only(name), (scale,))


def _add_scale(document: Document, mesh: Span, scale: float) -> None:
    text = f"{scale:.12g} {scale:.12g} {scale:.12g}"
    if mesh.children:  # SDF
        document.append(mesh, f"<scale>{text}</scale>", is_inline=True)
    else:
        document.set_attribute(mesh, "scale", text)


def _is_of_slide(limit: Span) -> bool:
    joint = limit.parent
    while joint is not None and joint.tag != "joint":
        joint = joint.parent
    return joint is not None and joint.attributes.get("type") == "prismatic"

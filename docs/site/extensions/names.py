"""Links from names in backticks, as `Run.trials` or `c2d.simulate(...)`, to the reference."""

import re
from collections.abc import Iterator

from docutils import nodes
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx
from sphinx.domains.python import PythonDomain
from sphinx.environment import BuildEnvironment
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util.nodes import make_refnode

CALL = re.compile(r"(?:c2d\.|crawler2d\.)?([A-Za-z_][\w.]*)(?:\(.*\))?")
CAPITAL = re.compile(r"(?<=[a-z])(?=[A-Z])")
MODULES = ("studies", "terrains", "robots")
"""Submodules whose names the pages use without them."""

VARIABLES = {"run": "Run", "robot": "Robot", "audit": "Audit", "sim": "Simulation"}
"""What the pages call an instance of a class."""


def spellings(name: str) -> Iterator[str]:
    """Yield the names that a name in backticks may stand for."""
    first, dot, rest = name.partition(".")
    yield f"crawler2d.{name}"
    if dot and first in VARIABLES:
        yield f"crawler2d.{VARIABLES[first]}.{rest}"
    for module in MODULES:
        yield f"crawler2d.{module}.{name}"
    # The class `HalfRound` is the function half_round.
    yield f"crawler2d.terrains.{CAPITAL.sub('_', name).lower()}"


def find(env: BuildEnvironment, text: str) -> tuple[str, str] | None:
    """Find the page and the anchor of what a text in backticks names."""
    call = CALL.fullmatch(text)
    domain = env.domains["py"]
    if call is None or not isinstance(domain, PythonDomain):
        return None
    for name in spellings(call[1]):
        if entry := domain.objects.get(name):
            return entry.docname, entry.node_id
    # Classes that only calls return, by the last of their name.
    for name, entry in domain.objects.items():
        if name.rpartition(".")[2] == call[1] and call[1][0].isupper():
            return entry.docname, entry.node_id
    return None


class LinkNames(SphinxPostTransform):
    """Link the names in backticks of all pages."""

    default_priority = 50

    def run(self) -> None:
        """Wrap each literal that names something in a reference to it."""
        here = self.env.current_document.docname
        for literal in list(self.document.findall(nodes.literal)):
            around = literal.parent
            if isinstance(around, (nodes.reference, pending_xref, nodes.title)):
                continue
            if (target := find(self.env, literal.astext())) and target[0] != here:
                link = make_refnode(self.app.builder, here, *target, literal.deepcopy())
                around.replace(literal, link)


def resolve_name(
    app: Sphinx, env: BuildEnvironment, node: pending_xref, content: nodes.TextElement
) -> nodes.Element | None:
    """Resolve a name in a docstring, or show it as code: parameters are in backticks, too."""
    if node.get("refdomain") != "py" or node["reftype"] not in {"obj", "class"}:
        return None
    if (target := find(env, node["reftarget"])) is None:
        content["classes"] = []  # those of a link
        return content if node["reftype"] == "obj" else None
    return make_refnode(app.builder, node["refdoc"], *target, content)


def leave_gallery(_app: Sphinx, docname: str, source: list[str]) -> None:
    """Leave the code of the gallery to sphinx-gallery, which links names itself."""
    if docname.startswith("gallery/") and docname != "gallery/index":
        source[0] = f".. autolink-skip:: file\n\n{source[0]}"


def setup(app: Sphinx) -> dict[str, bool]:
    """Work when pages are written and all names are known."""
    app.add_post_transform(LinkNames)
    app.connect("source-read", leave_gallery)
    app.connect("missing-reference", resolve_name)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

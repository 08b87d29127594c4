"""Mathematics as MathML, which browsers draw without a script: docutils translates it."""

import re

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.writers.html5 import HTML5Translator

BARE = re.compile(r"frac *\d\d")
"""A fraction without braces, which docutils takes for one number over what follows."""


def translate(formula: str, *, is_block: bool) -> str:
    """Translate TeX into MathML, or raise an error that names what is not known."""
    if BARE.search(formula):
        raise MathError(f"a fraction without braces: {formula}")
    return tex2mathml(formula, as_block=is_block)


def write_inline(writer: HTML5Translator, node: nodes.math) -> None:
    """Write a formula within a line."""
    writer.body.append(translate(node.astext(), is_block=False))
    raise nodes.SkipNode


def write_block(writer: HTML5Translator, node: nodes.math_block) -> None:
    """Write a displayed formula, which scrolls where it is wider than the page."""
    formula = translate(node.astext(), is_block=True)
    writer.body.append(f'<div class="formula" tabindex="0">{formula}</div>')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Name the renderer, for `html_math_renderer`."""
    app.add_html_math_renderer("mathml", (write_inline, None), (write_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}

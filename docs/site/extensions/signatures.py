"""Signatures of classes as they are called: else autodoc shows `(*_, **keywords)` of a base."""

import inspect
from typing import Any

from sphinx.application import Sphinx

from crawler2d.common.keywords import TakesKeywords


def called(
    _app: Sphinx, what: str, _name: str, obj: Any, _options: Any, _signature: str, _returns: str
) -> tuple[str, str] | None:
    """Write the parameters of `__init__` with their defaults; types are in the text."""
    if what != "class" or not (isinstance(obj, type) and issubclass(obj, TakesKeywords)):
        return None
    _, *parameters = inspect.signature(obj.__init__).parameters.values()
    plain = [each.replace(annotation=inspect.Parameter.empty) for each in parameters]
    return str(inspect.Signature(plain)), ""


def setup(app: Sphinx) -> dict[str, bool]:
    """Work when autodoc has found a signature."""
    app.connect("autodoc-process-signature", called)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

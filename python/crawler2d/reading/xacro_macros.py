"""Calls of macros: of unknown ones, which are left out, and as old xacro allowed them."""

from __future__ import annotations

from typing import Any
from xml.dom import minidom

from crawler2d.reading.xacro_files import XacroFiles
from crawler2d.reading.xacro_tree import OWN_OF_URDF, place_of

__all__ = ["XacroMacros"]


class XacroMacros:
    """Takes the place of what in xacro defines macros and calls them.

    Old xacro took macros as known before they are defined. So whoever meets such a call goes
    through the file a second time, with the macros of the first as `known`.

    Parameters
    ----------
    files : XacroFiles
        What is read, and what is noted.
    leave_out : bool
        Whether calls of unknown macros are left out, or refused.
    known : mapping of str to Any
        Macros that are known from the beginning.

    Attributes
    ----------
    defined : dict of str to Any
        Macros of the file and its includes, without those in namespaces.
    unknown : set of str
        Macros that were called and were not known.
    """

    def __init__(self, files: XacroFiles, *, leave_out: bool, known: dict[str, Any]) -> None:
        self.files = files
        self.leave_out = leave_out
        self.known = known
        self.defined: dict[str, Any] = {}
        self.unknown: set[str] = set()

    def attach(self, xacro: Any, own: Any) -> None:
        """Take the places in xacro; `own` are those that xacro has of its own."""
        define, call, resolve = own.grab_macro, own.handle_macro_call, own.resolve_macro

        def defined(element: minidom.Element, macros: Any) -> None:
            name = element.getAttribute("name").removeprefix("xacro:")
            define(element, macros)
            self.defined[name] = macros[name]

        def known(name: str, macros: Any, symbols: Any) -> Any:
            try:
                macro = resolve(name, macros, symbols)[2]
            except (KeyError, TypeError):  # of what is no macro, or no namespace
                return None
            return macro if isinstance(macro, own.Macro) else None

        def called(node: minidom.Element, macros: Any, symbols: Any) -> Any:
            name = node.tagName.removeprefix("xacro:")
            prefixed = name != node.tagName
            if node.tagName == "xacro:call" or (not prefixed and name in OWN_OF_URDF):
                return call(node, macros, symbols)
            macro = known(name, macros, symbols)
            if macro is None and name in self.known:
                macro = macros[name] = self.known[name]
                self.note(node, "is a macro that is defined later, which old xacro allowed")
            if not prefixed and macro not in xacro.macrostack and self.fits(node, macro):
                self.note(node, "is taken as a call of the macro, which old xacro allowed")
                node.tagName = node.nodeName = f"xacro:{name}"
            elif prefixed and macro is None and self.leave_out:
                self.unknown.add(name)
                lost = " and ".join(at for at, _ in self.files.left_out[:3])
                why = f"; what is included at {lost} was left out, too" if lost else ""
                self.note(node, f"is left out with what is in it: no file has such a macro{why}")
                own.replace_node(node, by=None)
                return True
            return call(node, macros, symbols)

        xacro.grab_macro, xacro.handle_macro_call = defined, called

    def note(self, node: minidom.Element, reason: str) -> None:
        """Doubt a call."""
        self.files.doubts.append((place_of(node), f"<{node.tagName}>", reason))

    def fits(self, node: minidom.Element, macro: Any) -> bool:
        """Whether an element without the prefix has the parameters of a macro, and its blocks."""
        if macro is None:
            return False
        given = set(node.attributes.keys())
        wanted = {name for name in macro.params if not name.startswith("*")}
        inside = [each for each in node.childNodes if each.nodeType == each.ELEMENT_NODE]
        return (
            given <= wanted
            and wanted - given <= macro.defaultmap.keys()
            and len(inside) == len(macro.params) - len(wanted)
        )

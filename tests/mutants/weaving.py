"""Sources of the core with many faults at once, each behind a switch.

A part with faults becomes an expression that asks which of them is on: `a + b` is then
`(if crate::switch::on(7) { (a) - (b) } else { (a) + (b) })`.
"""

import json
from collections import defaultdict
from dataclasses import dataclass
from typing import Any

import tree_sitter_rust
from tree_sitter import Language, Node, Parser

RUST = Parser(Language(tree_sitter_rust.language()))
HOLDERS = {
    "BinaryOperator": ("binary_expression", "compound_assignment_expr"),
    "UnaryOperator": ("unary_expression",),
    "FnValue": ("function_item",),
    "MatchArm": ("match_arm",),
    "MatchArmGuard": ("match_pattern",),
    "StructField": ("struct_expression",),
}
"""What is written anew for a fault, by what cargo-mutants calls its genre."""
CONSTANTS = ("const_item", "static_item", "array_type", "type_arguments")

Position = tuple[int, int]
"""A line and a column, from 1."""


@dataclass(frozen=True)
class Fault:
    """A fault in the list of cargo-mutants."""

    number: int
    name: str
    file: str
    genre: str
    replacement: str
    start: Position
    end: Position
    function: Position
    """Where its function begins."""

    @property
    def on(self) -> str:
        return f"crate::switch::on({self.number})"


def listed(text: str) -> list[Fault]:
    """Return what `cargo mutants --list --json` printed."""

    def position(at: dict[str, int]) -> Position:
        return at["line"], at["column"]

    return [
        Fault(
            number,
            entry["name"],
            entry["file"],
            entry["genre"],
            entry["replacement"],
            position(entry["span"]["start"]),
            position(entry["span"]["end"]),
            position((entry["function"] or entry)["span"]["start"]),
        )
        for number, entry in enumerate(json.loads(text))
    ]


def woven(text: str, faults: list[Fault]) -> str:
    """Return a source with those of its faults that can be switched."""
    source = text.encode()
    lines = text.splitlines(keepends=True)
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line.encode()))

    def offset(position: Position) -> int:
        line, column = position
        return starts[line - 1] + len(lines[line - 1][: column - 1].encode())

    root = RUST.parse(source).root_node
    held = defaultdict(list)
    for fault in faults:
        start = offset(fault.function if fault.genre == "FnValue" else fault.start)
        node = holder(root.descendant_for_byte_range(start, offset(fault.end)), fault)
        if node is not None and can_ask(node, fault):
            held[node.id].append((fault, start))
    return rendered(root, source, held)


def holder(node: Node | None, fault: Fault) -> Node | None:
    """Return the innermost node that is rewritten for a fault."""
    while node is not None and node.type not in HOLDERS[fault.genre]:
        node = node.parent
    return node


def can_ask(node: Node, fault: Fault) -> bool:
    """Whether it runs with the program, and a value can be returned whose type has a name."""
    if fault.genre == "FnValue":
        given = node.child_by_field_name("return_type")
        if given is not None and b"impl " in (given.text or b""):
            return False
    above: Node | None = node
    while above is not None and above.type not in CONSTANTS and not is_length(above):
        words = [
            child.text or b"" for child in above.children if child.type == "function_modifiers"
        ]
        if any(b"const" in each for each in words):
            return False
        above = above.parent
    return above is None


def is_length(node: Node) -> bool:
    """Whether it is the length of an array, which the compiler computes."""
    array = node.parent
    return array is not None and array.child_by_field_name("length") == node


def rendered(node: Node, source: bytes, held: dict[int, Any]) -> str:
    """Return the text of a node with the faults that it and its parts hold."""
    parts = {child.id: rendered(child, source, held) for child in node.children}
    if node.id not in held:
        return joined(node, source, parts)
    make = {
        "match_arm": arm,
        "match_pattern": guard,
        "function_item": function,
    }.get(node.type, choice)
    return make(node, source, parts, held[node.id])


def joined(node: Node, source: bytes, parts: dict[int, str]) -> str:
    if not node.children:
        return source[node.start_byte : node.end_byte].decode()
    text, at = "", node.start_byte
    for child in node.children:
        text += source[at : child.start_byte].decode() + parts[child.id]
        at = child.end_byte
    return text + source[at : node.end_byte].decode()


def choice(node: Node, source: bytes, parts: dict[int, str], faults: list[Any]) -> str:
    """Return an expression that is another one for each of its faults."""
    bracketed = dict(parts)
    for name in ("left", "right"):
        side = node.child_by_field_name(name)
        if side is not None:
            bracketed[side.id] = f"({parts[side.id]})"
    text = joined(node, source, bracketed)
    for fault, start in faults:
        changed = joined(node, source, bracketed | changes(node, fault, start))
        text = f"if {fault.on} {{ {changed} }} else {{ {text} }}"
    return f"({text})"


def changes(node: Node, fault: Fault, start: int) -> dict[int, str]:
    if fault.genre != "StructField":
        operator = next(child for child in node.children if child.start_byte == start)
        return {operator.id: fault.replacement}
    fields = node.child_by_field_name("body")
    assert fields is not None
    return {fields.id: without(fields, start)}


def without(fields: Node, start: int) -> str:
    """Return the fields of a struct without the one that begins at `start`."""
    kept = [
        (child.text or b"").decode()
        for child in fields.named_children
        if child.start_byte != start and child.type != "line_comment"
    ]
    return "{ " + ", ".join(kept) + " }"


def function(node: Node, source: bytes, parts: dict[int, str], faults: list[Any]) -> str:
    """Return a function that first checks whether to return a fault's value."""
    body = node.child_by_field_name("body")
    assert body is not None
    early = "".join(f"if {fault.on} {{ return {fault.replacement}; }} " for fault, _ in faults)
    return joined(node, source, parts | {body.id: "{ " + early + parts[body.id][1:]})


def arm(node: Node, source: bytes, parts: dict[int, str], faults: list[Any]) -> str:
    """Return an arm of a match that is skipped if its fault is on."""
    pattern = node.child_by_field_name("pattern")
    assert pattern is not None
    condition = pattern.child_by_field_name("condition")
    switch = " && ".join(f"!{fault.on}" for fault, _ in faults)
    if condition is None:
        changed = f"{parts[pattern.id]} if {switch}"
    else:
        before = source[pattern.start_byte : condition.start_byte].decode()
        whole = parts[pattern.id][len(before) :]
        changed = f"{before}{switch} && ({whole})"
    return joined(node, source, parts | {pattern.id: changed})


def guard(node: Node, source: bytes, parts: dict[int, str], faults: list[Any]) -> str:
    """Return a pattern whose guard is true or false if its fault is on."""
    condition = node.child_by_field_name("condition")
    assert condition is not None
    text = parts[condition.id]
    for fault, _ in faults:
        text = f"if {fault.on} {{ {fault.replacement} }} else {{ {text} }}"
    return joined(node, source, parts | {condition.id: f"({text})"})

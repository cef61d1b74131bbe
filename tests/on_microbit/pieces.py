"""Modules of the shared core cut into pieces that a heap of 9 KB can compile.

The compiler needs the source and its parse tree beside the code it makes; what a whole module
wants at once is more than there is. So every function and class goes over alone, without
docstrings and comments, by the raw REPL. Nothing else of the source is changed.
"""

import ast
from pathlib import Path

SHARED = Path(__file__).resolve().parents[2] / "shared" / "sixflip"


def without_docstrings(tree):
    """The tree itself, its docstrings gone."""
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)):
            first = node.body[0] if node.body else None
            if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
                node.body = node.body[1:] or [ast.Pass()]
    return tree


def of_module(name, *wanted):
    """Sources of a shared module's statements, one after the other; wanted: only those that
    define one of these names, and imports.

    Imports among the shared modules are left out: on the board all names are in one place.
    """
    tree = without_docstrings(ast.parse((SHARED / (name + ".py")).read_text()))
    for node in tree.body:
        among = isinstance(node, ast.ImportFrom) and node.module.startswith("sixflip")
        if not among and (not wanted or defined(node) & {None, *wanted}):
            yield ast.unparse(node)


def defined(node):
    """Names that a statement defines, {None} for an import."""
    if isinstance(node, (ast.Import, ast.ImportFrom)):
        return {None}
    if isinstance(node, ast.Assign):
        return {target.id for target in node.targets}
    return {getattr(node, "name", "")}


def of_modules(*names):
    return [piece for name in names for piece in of_module(name)]

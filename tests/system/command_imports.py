"""What the modules of commands import: most of it in the bodies of their functions."""

import ast
import pkgutil
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType


def modules_below(package: ModuleType) -> list[str]:
    """Return the modules of a package by name."""
    return [module.name for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}.")]


def imported_by(module: str) -> list[str]:
    """Return the modules of ours that a module imports anywhere, in the order in which it names them."""
    spec = find_spec(module)
    assert spec is not None
    assert spec.origin is not None
    nodes = ast.walk(ast.parse(Path(spec.origin).read_text(encoding="utf-8")))
    named = [node.module for node in nodes if isinstance(node, ast.ImportFrom) and node.module]
    return [name for name in dict.fromkeys(named) if name.startswith("catseye.")]

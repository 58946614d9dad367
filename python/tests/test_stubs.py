"""The stub of the compiled module names what there is, and nothing else."""

import ast
from pathlib import Path

import fjr
from fjr import _core


def public(names):
    return {name for name in names if not name.startswith("_")}


def own(cls):
    members = set(vars(cls)) - {"name", "value"} if hasattr(cls, "__members__") else set(vars(cls))
    return public(members)


def stub():
    text = (Path(fjr.__file__).parent / "_core.pyi").read_text()
    classes, others = {}, set()
    for node in ast.parse(text).body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            names = {part.name for part in node.body if isinstance(part, ast.FunctionDef)}
            names |= {part.targets[0].id for part in node.body if isinstance(part, ast.Assign)}
            classes[node.name] = public(names)
        elif isinstance(node, ast.FunctionDef):
            others.add(node.name)
        elif isinstance(node, ast.AnnAssign):
            others.add(node.target.id)
    return classes, others


def test_the_stub_is_complete():
    classes, others = stub()
    assert public(vars(_core)) == set(classes) | others
    for name, members in classes.items():
        assert own(getattr(_core, name)) == members, name


def test_the_package_has_what_it_says():
    assert all(hasattr(fjr, name) for name in fjr.__all__)
    assert all(getattr(fjr, name).__doc__ for name in fjr.__all__ if name != "__version__")

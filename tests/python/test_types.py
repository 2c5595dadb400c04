"""Types: every call has annotations and an example, and the stubs are those of the module."""

import ast
import importlib.util
import inspect
import os
import pathlib
import re
import subprocess
import sys

import hmax
import pytest
from hmax import _core

PACKAGE = pathlib.Path(hmax.__file__).parent


def public_functions():
    return [value for name, value in vars(hmax).items() if name in hmax.__all__ and inspect.isfunction(value)]


def test_every_public_name_is_there():
    assert all(hasattr(hmax, name) for name in hmax.__all__)
    assert hmax.__all__ == sorted(hmax.__all__)
    assert (PACKAGE / "py.typed").exists()


@pytest.mark.parametrize("function", public_functions(), ids=lambda function: function.__name__)
def test_a_call_has_types_and_a_docstring_with_an_example(function):
    signature = inspect.signature(function)
    assert signature.return_annotation is not inspect.Signature.empty
    for parameter in signature.parameters.values():
        assert parameter.annotation is not inspect.Parameter.empty, parameter
        if parameter.kind is not inspect.Parameter.VAR_KEYWORD:
            assert re.search(rf"\b{parameter.name}\b", function.__doc__), f"{parameter.name} is not explained"
    assert ">>>" in function.__doc__


def test_the_stubs_name_what_the_module_has():
    stub = ast.parse((PACKAGE / "_core.pyi").read_text())
    functions = {node.name: len(node.args.args) for node in stub.body if isinstance(node, ast.FunctionDef)}
    assert set(functions) == {name for name in vars(_core) if not name.startswith("_")} - {"Model", "Body"}
    for name, count in functions.items():
        assert arguments_of(getattr(_core, name)) == count, name
    for node in (node for node in stub.body if isinstance(node, ast.ClassDef)):
        held = getattr(_core, node.name)
        methods = {inner.name: len(inner.args.args) for inner in node.body if isinstance(inner, ast.FunctionDef)}
        attributes = {inner.target.id for inner in node.body if isinstance(inner, ast.AnnAssign)}
        assert set(methods) - {"__init__"} | attributes == {name for name in vars(held) if not name.startswith("_")}
        for name, count in methods.items():
            assert arguments_of(getattr(held, name)) == count, name


def arguments_of(function):
    """The number of arguments, as pybind11 writes it in the docstring."""
    inside = re.match(r"\w+\((.*)\) ->", function.__doc__.splitlines()[0])[1]
    return len(re.findall(r"\b(?:self|arg\d+): ", inside))


def test_mypy_finds_no_mistake():
    if not importlib.util.find_spec("mypy"):
        pytest.skip("mypy is not installed")
    told = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports", "--cache-dir", os.devnull, PACKAGE], check=False, capture_output=True, text=True)
    assert told.returncode == 0, told.stdout

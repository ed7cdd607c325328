"""aerate/__init__.pyi says what the module is."""

import ast
import dataclasses
import inspect
from pathlib import Path

import pytest

import aerate
from aerate import _core

STUB = ast.parse(Path(aerate.__file__).with_name("__init__.pyi").read_text())
DEFINED = {
    each.name: each
    for each in STUB.body
    if isinstance(each, (ast.FunctionDef, ast.ClassDef)) and not each.name.startswith("_")
}


def test_the_package_is_marked_as_typed():
    assert Path(aerate.__file__).with_name("py.typed").exists()


def test_names_are_those_of_the_module():
    assert set(DEFINED) == set(aerate.__all__)
    assert [each.target.id for each in STUB.body if isinstance(each, ast.AnnAssign)] == ["__version__"]
    for name, defined in DEFINED.items():
        assert inspect.isclass(getattr(aerate, name)) == isinstance(defined, ast.ClassDef)


def test_load_has_its_parameters():
    parameters = inspect.signature(aerate.load).parameters.values()
    arguments = DEFINED["load"].args
    assert [each.arg for each in arguments.args] == [each.name for each in parameters if each.kind == each.POSITIONAL_OR_KEYWORD]
    assert [each.arg for each in arguments.kwonlyargs] == [each.name for each in parameters if each.kind == each.KEYWORD_ONLY]
    assert {row[0] for row in _core.options("load")} == {"unit", "scale", "config"}


@pytest.mark.parametrize("command", ["inspect", "pack", "hollow"])
def test_functions_have_every_option_and_no_other(command):
    arguments = DEFINED[command].args
    kinds = {each.arg: ast.unparse(each.annotation) for each in arguments.kwonlyargs}
    assert kinds.pop("progress") == "_Progress" and [each.arg for each in arguments.args] == ["model"]
    options = {}
    for name, is_list, is_flag, _, may_be_bare, value, _ in _core.options(command):
        kind = "_List" if is_list else "_Flag" if is_flag and not may_be_bare else "_Value"
        options["as_" if name == "as" else name.replace("-", "_")] = "_FlagOrValue" if may_be_bare else kind
    assert kinds == options
    assert all(ast.unparse(each) == "..." for each in arguments.kw_defaults)


@pytest.mark.parametrize("name", ["Model", "Packing", "Hollowed"])
def test_results_have_their_fields(name):
    fields = [each.target.id for each in DEFINED[name].body if isinstance(each, ast.AnnAssign)]
    assert fields == [each.name for each in dataclasses.fields(getattr(aerate, name))]


@pytest.mark.parametrize("name", [name for name in aerate.__all__ if name.endswith("Error")])
def test_errors_have_their_bases(name):
    bases = [ast.unparse(each) for each in DEFINED[name].bases]
    assert bases == [each.__name__ for each in getattr(aerate, name).__bases__]

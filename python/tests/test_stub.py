"""The types in gaitway.pyi are those of the program."""

import ast
import inspect
import re
from collections.abc import Iterator

import pytest
from support import REPOSITORY, text_of_cli

import gaitway

STUB = ast.parse((REPOSITORY / "python" / "gaitway.pyi").read_text())
# Only for type checkers.
TYPES = {"ExportOptions", "RetargetOptions"}


def declared(body: list[ast.stmt]) -> dict[str, ast.stmt]:
    return {node.name: node for node in body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}


def members() -> Iterator[tuple[str, ast.stmt, object]]:
    """Yields all classes, functions, methods and properties of the stub with what the program has by that name."""
    for name, node in declared(STUB.body).items():
        if name not in TYPES:
            yield name, node, getattr(gaitway, name)
            for member, inner in declared(getattr(node, "body", [])).items():
                yield f"{name}.{member}", inner, inspect.getattr_static(getattr(gaitway, name), member)


def test_the_stub_declares_everything() -> None:
    for name, node in declared(STUB.body).items():
        if isinstance(node, ast.ClassDef) and name not in TYPES:
            public = {member for member in vars(getattr(gaitway, name)) if not member.startswith("_")}
            assert public == set(declared(node.body)), name
    # The package wraps a module of the same name.
    public = {name for name, value in vars(gaitway).items() if not name.startswith("_") and not inspect.ismodule(value)}
    assert public == set(declared(STUB.body)) - TYPES


@pytest.mark.parametrize(("name", "node", "found"), [pytest.param(*member, id=member[0]) for member in members()])
def test_signatures_and_docstrings(name: str, node: ast.stmt, found: object) -> None:
    found = found.__func__ if isinstance(found, staticmethod) else found
    assert inspect.getdoc(found), f"{name} has no docstring"
    if isinstance(node, ast.ClassDef):
        assert [ast.unparse(base) for base in node.bases] == [
            base.__name__ for base in found.__bases__ if base is not object
        ]
    elif not any(isinstance(decorator, ast.Name) and decorator.id == "property" for decorator in node.decorator_list):
        parameters = inspect.signature(found).parameters.values()
        arguments = node.args
        kinds = {
            inspect.Parameter.POSITIONAL_OR_KEYWORD: [argument.arg for argument in arguments.args],
            inspect.Parameter.KEYWORD_ONLY: [argument.arg for argument in arguments.kwonlyargs],
            inspect.Parameter.VAR_POSITIONAL: [arguments.vararg.arg] if arguments.vararg else [],
            inspect.Parameter.VAR_KEYWORD: [arguments.kwarg.arg] if arguments.kwarg else [],
        }
        for kind, names in kinds.items():
            names_found = [parameter.name for parameter in parameters if parameter.kind == kind]
            # `self` may be positional only.
            assert [name for name in names_found if name != "self"] == [name for name in names if name != "self"]


def test_options_are_those_of_the_command_line() -> None:
    of_files = {"model", "motion", "map", "out", "out_dir", "jobs", "clip_only", "json", "help"}
    commands = {"retarget": ("RetargetOptions", of_files | {"format"}), "export": ("ExportOptions", of_files)}
    for command, (name, others) in commands.items():
        options = re.findall(r"^ *(?:-\w, )?--([a-z-]+)", text_of_cli(command, "--help"), flags=re.MULTILINE)
        keys = [node.target.id.removesuffix("_") for node in declared(STUB.body)[name].body]
        assert {option.replace("-", "_") for option in options} - others == set(keys)

"""What is said about the package: stubs, documentation, examples."""

import ast
import doctest
import importlib
import inspect
import runpy
import sys
from importlib.metadata import metadata
from pathlib import Path

import pytest
from conftest import RECORDINGS, REPOSITORY

import reorder
from reorder import _reorder

PACKAGE = Path(reorder.__file__).parent


def stubs():
    return ast.parse((PACKAGE / "_reorder.pyi").read_text()).body


def documented(node, what):
    said = ast.get_docstring(node)
    if said is not None:
        assert inspect.cleandoc(what.__doc__ or "") == said, node.name


def parameters(node):
    given = node.args
    return [argument.arg for argument in given.posonlyargs + given.args + given.kwonlyargs]


def test_the_stubs_say_what_is_there():
    assert (PACKAGE / "py.typed").exists()
    names = {node.name for node in stubs() if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    assert names == {name for name in dir(_reorder) if not name.startswith("__")}
    for node in stubs():
        if isinstance(node, ast.FunctionDef):
            assert parameters(node) == list(inspect.signature(getattr(_reorder, node.name)).parameters), node.name
        if not isinstance(node, ast.ClassDef):
            continue
        compiled = getattr(_reorder, node.name)
        documented(node, compiled)
        methods = [method for method in node.body if isinstance(method, ast.FunctionDef)]
        public = {name for name in vars(compiled) if not name.startswith("_")}
        assert public == {method.name for method in methods if not method.name.startswith("_")}, node.name
        for method in methods:
            what = getattr(compiled, method.name)
            documented(method, what)
            if not method.name.startswith("__") and not method.decorator_list:
                assert parameters(method) == list(inspect.signature(what).parameters), (node.name, method.name)


def test_all_that_is_public_is_documented():
    for name in reorder.__all__:
        what = getattr(reorder, name)
        assert what.__doc__ and len(what.__doc__) > 20, name
        module = getattr(what, "__module__", "reorder") or "reorder"
        assert module.split(".")[0] == "reorder", (name, module)


@pytest.mark.parametrize("module", ["reorder", "reorder._manifolds", "reorder._order"])
def test_the_examples_of_the_documentation_run(module):
    ran = doctest.testmod(importlib.import_module(module))
    assert ran.failed == 0 and ran.attempted > 0


def test_the_wheel_is_for_every_python_since_3_9():
    about = metadata("reorder")
    assert about["Requires-Python"] == ">=3.9" and about["Version"]
    assert Path(_reorder.__file__).name.endswith(".abi3.so")


@pytest.mark.parametrize("page", ["README.md", "crates/reorder-py/README.md"])
def test_the_program_of_the_read_me_runs(page, monkeypatch, capsys):
    monkeypatch.chdir(REPOSITORY)
    program = (REPOSITORY / page).read_text().split("```python\nimport reorder\n")[1].split("```")[0]
    exec(compile(f"import reorder\n{program}", page, "exec"), {})
    assert "certified" in capsys.readouterr().out


def test_the_example_makes_a_plot_of_a_bag(tmp_path, monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "Agg")
    example = REPOSITORY / "crates" / "reorder-py" / "examples" / "bag_to_plot.py"
    picture = tmp_path / "plot.png"
    monkeypatch.setattr(sys, "argv", [str(example), str(RECORDINGS / "lasa_gshape"), str(picture)])
    runpy.run_path(str(example), run_name="__main__")
    assert picture.stat().st_size > 10_000

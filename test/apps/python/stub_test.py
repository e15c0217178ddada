"""The type stubs say what the module has: names, fields, arguments and their defaults."""

import ast
import inspect
import pathlib
import re

import plumbline

STUB = ast.parse((pathlib.Path(plumbline.__file__).parent / "__init__.pyi").read_text())
CLASSES = {node.name: node for node in STUB.body if isinstance(node, ast.ClassDef)}
NEW_IN_MODULE = set(vars(plumbline._plumbline)) - set(vars(type(plumbline)))


def is_public(name):
    return not name.startswith("_")


def stub_members(class_node):
    """The definitions of a class by name, those of its private bases included."""
    members = {}
    for base in class_node.bases:
        if isinstance(base, ast.Name) and base.id.startswith("_"):
            members.update(stub_members(CLASSES[base.id]))
    for node in class_node.body:
        name = node.target.id if isinstance(node, ast.AnnAssign) else getattr(node, "name", None)
        if name is not None:
            members.setdefault(name, [])
            members[name] = [m for m in members[name] if m in class_node.body] + [node]
    return members


def stub_signature(function):
    """Names of the arguments, with '=' where there is a default."""
    arguments = function.args.args
    without_default = len(arguments) - len(function.args.defaults)
    names = [a.arg + ("=" if i >= without_default else "") for i, a in enumerate(arguments)]
    if names and names[0] in ("self", "arg0"):
        names = names[1:]
    return names + (["**"] if function.args.kwarg else [])


def module_signatures(function, name):
    """The same of a function of the extension, which has its signatures in its docstring."""
    signatures = []
    for line in re.findall(rf"^(?:\d+\. )?{name}\((.*)\) -> ", function.__doc__, re.MULTILINE):
        if line == "*args, **kwargs":
            continue
        without_types = re.sub(r"\[[^\[\]]*\]", "", re.sub(r"\[[^\[\]]*\]", "", line))
        without_calls = re.sub(r"\(\)", "", without_types)
        arguments = []
        for argument in filter(None, without_calls.split(", ")):
            if argument.startswith("**"):
                arguments.append("**")
            else:
                arguments.append(argument.split(":")[0] + ("=" if " = " in argument else ""))
        signatures.append(arguments[1:] if arguments[:1] in (["self"], ["arg0"]) else arguments)
    return signatures


def expect_same_signatures(function, name, nodes):
    assert module_signatures(function, name.split(".")[-1]) == [
        stub_signature(node) for node in nodes
    ], name


def test_every_public_name_is_in_both():
    in_stub = {n.name for n in STUB.body if isinstance(n, (ast.ClassDef, ast.FunctionDef))}
    in_module = {name for name in vars(plumbline) if is_public(name)}
    assert set(filter(is_public, in_stub)) == in_module


def test_classes_have_the_same_members():
    compared = 0
    for name, node in CLASSES.items():
        if not is_public(name):
            continue
        actual = getattr(plumbline, name)
        members = stub_members(node)
        if issubclass(actual, Exception):
            assert [b.__name__ for b in actual.__bases__] == [b.id for b in node.bases], name
            continue
        assert set(filter(is_public, members)) == set(filter(is_public, dir(actual))), name
        for member, nodes in members.items():
            value = inspect.getattr_static(actual, member)
            if isinstance(value, property):
                settable = any(
                    isinstance(n, ast.AnnAssign) and "Final" not in ast.dump(n.annotation)
                    or isinstance(n, ast.FunctionDef) and "setter" in ast.dump(n)
                    for n in nodes
                )
                assert settable == (value.fset is not None), f"{name}.{member}"
                compared += 1
            elif isinstance(nodes[0], ast.FunctionDef) and is_public(member):
                expect_same_signatures(value, f"{name}.{member}", nodes)
                compared += 1
        if "__init__" in members and members["__init__"][0] in node.body:
            expect_same_signatures(actual.__init__, f"{name}.__init__", members["__init__"])
    assert compared > 300


def test_functions_have_the_same_arguments():
    functions = [node for node in STUB.body if isinstance(node, ast.FunctionDef)]
    for node in functions:
        expect_same_signatures(getattr(plumbline, node.name), node.name, [node])
    assert len(functions) > 20


def test_everything_has_a_docstring():
    for name, value in vars(plumbline).items():
        if is_public(name) and (inspect.isclass(value) or inspect.isbuiltin(value)):
            text = re.sub(rf"(?m)^{name}\(.*\) -> .*$", "", value.__doc__ or "").strip()
            assert text, f"{name} has no docstring"


def test_the_package_says_that_it_is_typed():
    assert (pathlib.Path(plumbline.__file__).parent / "py.typed").exists()

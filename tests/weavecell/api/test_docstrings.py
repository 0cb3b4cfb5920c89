"""Public names have docstrings with parameters, units and errors: a numpydoc check of its own, over `__all__`."""

import importlib
import inspect
import re

import pytest

PACKAGES = ("weavecell", "shellfabric", "unitcell3d", "meshing", "fabrics")


def public(package):
    """{name: object} of the functions and classes in `__all__`."""
    module = importlib.import_module(package)
    found = {name: getattr(module, name) for name in module.__all__}
    return {name: each for name, each in found.items() if inspect.isfunction(each) or inspect.isclass(each)}


def sections(text):
    """{heading: body} of a numpydoc docstring."""
    parts = re.split(r"^(\w[\w ]*)\n-{3,}$", text, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2]))


def documented(body):
    """Names that a section "Parameters" documents."""
    body = re.sub(r",\n\s+", ", ", body)  # a list of names that goes on
    names = [line.partition(" :")[0] for line in body.splitlines() if re.match(r"\S.* :", line)]
    return {name.strip().lstrip("*") for line in names for name in line.split(",")}


def problems(name, found):
    """What the docstring of a function or class lacks."""
    text = inspect.getdoc(found) or ""
    if not text:
        return [f"{name}: no docstring"]
    first, parts = text.split("\n\n")[0], sections(text)
    wrong = [] if len(first.split()) > 1 else [f"{name}: no purpose"]
    if inspect.isclass(found) and not hasattr(found, "__dataclass_fields__") and "__init__" not in vars(found):
        return wrong
    skipped = {"self", "args", "kwargs"}
    given = [key for key in inspect.signature(found).parameters if key not in skipped and not key.startswith("_")]
    above = [sections(inspect.cleandoc(kind.__doc__ or "")) for kind in getattr(found, "__mro__", ())[1:-1]]
    known = set().union(*(documented(each.get("Parameters", "")) for each in (parts, *above)))
    wrong += [f"{name}: parameter {key}" for key in given if key not in known]
    return wrong


def load(package):
    if package == "unitcell3d":
        pytest.importorskip("dolfinx")
    if package == "meshing":
        pytest.importorskip("gmsh")
    return public(package)


@pytest.mark.parametrize("package", PACKAGES)
def test_public_names_are_documented(package):
    assert [line for name, each in load(package).items() for line in problems(f"{package}.{name}", each)] == []


@pytest.mark.parametrize("package", PACKAGES)
def test_a_public_function_that_raises_says_so(package):
    for name, each in load(package).items():
        if inspect.isfunction(each) and "raise " in inspect.getsource(each):
            assert "Raises" in sections(inspect.getdoc(each)), f"{package}.{name}"


def test_what_is_missing_is_found():
    def shoot(velocity, mass):
        """Fire a projectile.

        Parameters
        ----------
        velocity : [m/s]
        """

    assert problems("shoot", shoot) == ["shoot: parameter mass"]

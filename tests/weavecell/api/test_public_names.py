"""The public names of the packages: each is there, documented, and the one that the stub for type checkers names."""

import ast
import importlib
from pathlib import Path

import pytest


@pytest.mark.parametrize("name", ["fabrics", "meshing", "shellfabric", "unitcell3d", "weavecell"])
def test_every_name_is_there(name):
    if name == "unitcell3d":
        pytest.importorskip("dolfinx")
    package = importlib.import_module(name)
    stub = Path(package.__file__).with_suffix(".pyi").read_text("utf-8")
    (listed,) = (line.value for line in ast.parse(stub).body if ast.unparse(line).startswith("__all__"))
    assert package.__all__ == sorted(ast.literal_eval(listed))
    assert set(package.__all__) <= set(dir(package))
    for one in package.__all__:
        assert getattr(package, one).__doc__, one
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        package.nothing  # noqa: B018

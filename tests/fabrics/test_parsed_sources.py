"""What is kept of parsed files is that of their present content."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_kept_results_are_those_of_the_content(tmp_path):
    """A second process parses nothing; a changed file is parsed anew."""
    package = tmp_path / "fabrics"
    package.mkdir()
    for name in ("__init__.py", "__init__.pyi", "lazy.py", "source_code.py", "errors.py", "checks.py"):
        (package / name).write_bytes((ROOT / "fabrics" / name).read_bytes())
    other = package / "other.py"
    code = (
        "import ast\nfrom fabrics import source_code\nfrom pathlib import Path\n"
        "parse, count = ast.parse, []\nast.parse = lambda *a: count.append(1) or parse(*a)\n"
        "file = Path('fabrics/other.py').resolve()\n"
        "print(*source_code.imports(file), source_code.named_tuples(file).decode()[:6], len(count))"
    )

    def run():
        path = {"PYTHONPATH": str(tmp_path), "PATH": "/usr/bin"}
        done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env=path, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout.split()

    other.write_text("import math\nP = namedtuple('P', 'a')\n")
    assert run() == ["math", "Call(f", "2"]
    assert run() == ["math", "Call(f", "0"]
    other.write_text("import cmath\nP = namedtuple('P', 'a')\n")
    assert run() == ["cmath", "Call(f", "2"]
    kept = next((package / "__pycache__").glob("parsed-sources-*.json"))
    kept.write_text("broken")
    assert run() == ["cmath", "Call(f", "2"]

"""The generator shares nothing with the product: by its source, and by running it alone."""

import ast
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
BLIND = ROOT / "tests" / "studies" / "blind"
FORBIDDEN = {"sixflip", "sixflip_sim", "sixflip_host", "sixflip_device"}
ALLOWED = {"numpy", "scipy"} | set(sys.stdlib_module_names)

ALONE = """
import sys
class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in %r:
            raise ImportError("the blind generator reached for " + name)
sys.meta_path.insert(0, Blocked())
from tests.studies.blind.generator.case import Case, Specification
from tests.studies.blind.judged import judged
case = Case(Specification(7, "gy85", "paper", [("thermal_bias", "accel", 1.0)]))
judged(case)
for path in case.write(%r):
    print(path)
assert not %r & {name.split(".")[0] for name in sys.modules}
"""


def imported(path):
    """Top-level packages a source file imports; relative imports are the generator's own."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield node.module.split(".")[0]
        elif isinstance(node, ast.Call) and getattr(node.func, "id", "") == "__import__":
            yield "__import__"


def test_sources_import_only_numpy_and_scipy():
    sources = list((BLIND / "generator").rglob("*.py"))
    assert len(sources) > 10
    for source in sources:
        assert set(imported(source)) <= ALLOWED - {"importlib"}, source.name


def test_theory_of_what_can_be_told_apart_is_independent_too():
    for name in ("judged.py", "identifiability.py"):
        assert not set(imported(BLIND / name)) & FORBIDDEN


def test_it_runs_where_the_product_is_blocked(tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", ALONE % (FORBIDDEN, str(tmp_path / "alone"), FORBIDDEN)],
        cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    first = Path(done.stdout.split()[0]).read_text().splitlines()
    assert first[0] == "# sixflip-capture 1"
    assert first[2] == "t_us,ax,ay,az,gx,gy,gz,temp,pose"

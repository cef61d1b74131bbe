"""The host's rooms import each other one way: what a file needs lies in a lower room."""

import ast
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HOST = ROOT / "host" / "sixflip_host"
STUDIES = ROOT / "tests" / "studies"


def imports():
    """{(room, room imported): [files]} of every module below host/sixflip_host, verbs included."""
    found = {}
    for path in sorted(HOST.rglob("*.py")):
        package = path.relative_to(HOST).parts[:-1]
        if not package or "on_board" in package:
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if not isinstance(node, ast.ImportFrom) or not node.level:
                continue
            above = package[:len(package) - node.level + 1]
            names = [*above, *(node.module.split(".") if node.module else ())]
            reached = [names] if names else [[one.name] for one in node.names]
            for one in reached:
                if (HOST / one[0]).is_dir() and one[0] != package[0]:
                    found.setdefault((package[0], one[0]), []).append(path.name)
    return found


def files():
    """[(module, module it imports)] of every file below host/sixflip_host, in functions, too."""
    modules = {path.relative_to(HOST).with_suffix("").parts for path in HOST.rglob("*.py")
               if path.name != "__init__.py"}
    for module in sorted(modules):
        for node in ast.walk(ast.parse(HOST.joinpath(*module).with_suffix(".py").read_text())):
            if isinstance(node, ast.ImportFrom) and node.level:
                above = module[:len(module) - node.level]
                lower = (*above, *(node.module.split(".") if node.module else ()))
                for one in {lower, *((*lower, name.name) for name in node.names)} & modules:
                    yield module, one


def order(pairs):
    """Rooms from the lowest up; AssertionError with the rooms of a circle."""
    needs = {}
    for room, lower in pairs:
        needs.setdefault(room, set()).add(lower)
        needs.setdefault(lower, set())
    found = []
    while needs:
        ready = sorted(room for room, lower in needs.items() if not lower - set(found))
        assert ready, "a circle among %s" % sorted(needs)
        found += ready
        for room in ready:
            del needs[room]
    return found


def test_no_circles_and_the_order_of_the_design():
    found = imports()
    assert len(found) > 20                      # the reader of imports sees them at all
    rooms = order(found)
    levels = [rooms.index(room) for room in ("capture", "experiment", "calibrate")]
    assert levels == sorted(levels)
    for room in ("planning", "diagnosis", "simulation"):
        assert rooms.index("experiment") < rooms.index(room) < rooms.index("verbs"), rooms
    assert rooms.index("diagnosis") < rooms.index("present")


def test_nothing_imports_a_verb_but_another_verb():
    assert not [(room, files) for (room, lower), files in imports().items() if lower == "verbs"]


def test_no_file_imports_one_that_imports_it():
    found = set(files())
    assert len(found) > 1000
    order(found)


def test_a_circle_is_seen():
    try:
        order([("a", "b"), ("b", "c"), ("c", "a"), ("d", "a")])
    except AssertionError as error:
        assert "'a', 'b', 'c'" in str(error)
    else:
        raise AssertionError("no circle was seen")


def test_a_study_is_found_by_its_package_and_changes_no_path():
    sources = list(STUDIES.rglob("*.py"))
    assert len(sources) > 50
    assert not [path.name for path in sources if "sys.path" in path.read_text()]
    assert not list(STUDIES.rglob("test_*.py"))


def public(tree):
    """Functions, classes and methods whose names begin with no underscore."""
    for node in tree.body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and not node.name.startswith("_"):
            yield node
        if isinstance(node, ast.ClassDef):
            yield from public(node)


def test_what_the_board_runs_says_what_it_does():
    silent, seen = [], 0
    for path in [*(ROOT / "device").rglob("*.py"), *(ROOT / "shared").rglob("*.py")]:
        tree = ast.parse(path.read_text())
        for node in [*([tree] if tree.body else []), *public(tree)]:
            seen += 1
            if not ast.get_docstring(node):
                silent.append("%s: %s" % (path.name, getattr(node, "name", "the module")))
    assert seen > 400
    assert silent == []

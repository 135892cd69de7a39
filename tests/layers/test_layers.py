"""The rules of the house, read off the imports and definitions (manual/developer-guide.md lists them)."""

import ast
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DECK, SOLVER = ROOT / "parser/pound_deck", ROOT / "solver/pound_solve"

# from the bottom to the top: a module may import its own layer and those below
LAYERS = (
    ("laws", "jit", "matrices", "dofs", "chords", "modes", "polynomial", "pounding", "records", "sketch"),
    ("motions", "forces"),
    ("hysteresis", "contact", "damping"),
    ("elements",),
    ("assemble",),
    ("diaphragms", "scene"),
    ("integrate",),
    ("analyses",),
    ("catalog", "tables"),
    ("results", "echo", "reference"),
    ("report", "export", "loop", "plot", "explain"),
    ("separation",),
    ("course",),
    ("app",),
    ("study", "extremes", "stability"),
    ("__init__",),
    ("cli",),
    ("__main__",),
)
LEVEL = {name: i for i, names in enumerate(LAYERS) for name in names}
#: who may import a library, as paths below the two roots
ONLY_IN = {
    "lark": {"cards.py"},
    "h5py": {"results.py"},
    "tabulate": {"report.py"},
    "matplotlib": {"style.py"},
    "numba": {"jit.py"},
}


def modules():
    return [*DECK.rglob("*.py"), *SOLVER.rglob("*.py")]


def imported(path):
    """Dotted names of everything a module imports, within functions too."""
    out = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            out |= {a.name for a in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            out |= {f"{node.module}.{a.name}" for a in node.names}
    return out


def part(dotted):
    """The first folder or module below ``pound_solve``."""
    words = dotted.split(".")
    return words[1] if len(words) > 1 and words[1] in LEVEL else "__init__"


def test_the_parser_knows_nothing_of_the_solver_nor_of_numbers():
    allowed = set(sys.stdlib_module_names) | {"lark", "pound_deck"}
    for path in DECK.rglob("*.py"):
        assert {name.split(".")[0] for name in imported(path)} <= allowed, path


@pytest.mark.parametrize("library", ONLY_IN)
def test_each_library_has_one_door(library):
    users = {p.name for p in modules() if any(n.split(".")[0] == library for n in imported(p))}
    assert users <= ONLY_IN[library]


def test_the_solver_takes_the_model_from_the_parser_and_only_the_top_reads_decks():
    for path in SOLVER.rglob("*.py"):
        taken = {n.split(".")[1] for n in imported(path) if n.startswith("pound_deck.")}
        allowed = {"model", "schema", "diagnostics"}
        if path.name in ("app.py", "cli.py", "loop.py"):
            allowed |= {"reader"}
        if path.name == "reference.py":
            allowed |= {"sections"}
        assert taken <= allowed, path


def test_imports_go_down():
    for path in SOLVER.rglob("*.py"):
        own = path.relative_to(SOLVER).parts[0].removesuffix(".py")
        for name in imported(path):
            if (
                name.startswith("pound_solve")
                and part(name) != own
                and not name.startswith("pound_solve.__version__")
            ):
                assert LEVEL[part(name)] <= LEVEL[own], f"{path.name} imports {name}"


def test_numerics_open_no_file_and_print_nothing():
    folders = ("elements", "hysteresis", "contact", "damping", "forces", "integrate", "analyses")
    files = [p for f in folders for p in (SOLVER / f).rglob("*.py")]
    files += [
        SOLVER / n
        for n in (
            "laws.py",
            "matrices.py",
            "dofs.py",
            "modes.py",
            "assemble.py",
            "scene.py",
            "loop.py",
            "sketch.py",
        )
    ]
    for path in files:
        called = {
            n.func.id
            for n in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            if isinstance(n, ast.Call) and isinstance(n.func, ast.Name)
        }
        assert not called & {"open", "print", "input", "eval", "exec"}, path


def test_no_module_keeps_mutable_state():
    for path in modules():
        tree = ast.parse(path.read_text(encoding="utf-8"))
        assert not [n for n in ast.walk(tree) if isinstance(n, ast.Global)], path
        for node in tree.body:
            # a display may stand at module level only as a constant, in capitals,
            # and is never changed in place
            if isinstance(node, ast.Assign) and isinstance(
                node.value, ast.List | ast.Dict | ast.Set | ast.ListComp
            ):
                names = [t.id for t in node.targets if isinstance(t, ast.Name)]
                assert all(n == n.upper() for n in names), f"{path}: {names}"
                changed = {
                    n.func.value.id
                    for n in ast.walk(tree)
                    if isinstance(n, ast.Call)
                    and isinstance(n.func, ast.Attribute)
                    and isinstance(n.func.value, ast.Name)
                    and n.func.attr in ("append", "add", "update", "pop", "setdefault", "extend", "clear")
                }
                assert not changed & set(names), path


def test_no_function_evaluates_text():
    for path in modules():
        called = {
            n.func.id
            for n in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            if isinstance(n, ast.Call) and isinstance(n.func, ast.Name)
        }
        assert not called & {"eval", "exec"}, path

"""The rules of the architecture, read off the imports and definitions (manual/developer-guide.md lists
them).
"""

import ast
import builtins
import re
import sys
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).parents[2]
DECK, IMPORT, SOLVER = (
    ROOT / name for name in ("parser/pound_deck", "parser/pound_import", "solver/pound_solve")
)

#: layers, the lowest first: a layer may import only from itself and from layers below it
LAYERS = (
    "version",
    "deck",
    "modules",
    "interruption",
    "check",
    "user_error",
    "numerics",
    "loading",
    "laws",
    "structure",
    "integrate",
    "analyses",
    "catalog",
    "results",
    "statistics",
    "report",
    "driver",
    "__init__",
    "assess",
    "opensees",
    "sweep",
    "sensitivity",
    "editor",
    "cli",
    "__main__",
)
#: folders and modules within a layer, likewise; other modules of the layer may import all of them
WITHIN = {
    "loading": ("records", "motions", "forces"),
    "laws": (
        "automaton",
        "functions",
        "condensed",
        "mirror",
        "two_bars",
        "contact",
        "damper",
        "hysteresis",
    ),
    "integrate": (
        "protocol",
        "costs",
        "intervals",
        "release",
        "rigid",
        "kernels",
        "events",
        "condensed",
        "propagators",
        "stepping",
        "series",
        "closed_form",
        "convergence",
        "trial",
        "auto",
    ),
    "results": (
        "schema",
        "form",
        "safe_file",
        "place",
        "words",
        "columns",
        "study_record",
        "record",
        "remarks",
        "histories",
        "tables",
        "contents",
        "axes",
        "frames",
        "writer",
        "reader",
        "vtkhdf",
        "sweep_file",
    ),
    "editor": (
        "reading",
        "fields",
        "names",
        "definition",
        "rename",
        "symbols",
        "hover",
        "complete",
        "diagnose",
        "project",
        "server",
    ),
    "opensees": (
        "script",
        "rules",
        "impacts",
        "frames",
        "springs",
        "supports",
        "damping",
        "loads",
        "motions",
        "peaks",
        "template",
        "export",
        "extrapolation",
        "environment",
        "verify",
        "page",
    ),
    "statistics": (
        "over_records",
        "design_variable",
        "distributions",
        "replicates",
        "sobol_indices",
        "fragility",
        "separation",
        "incremental",
        "curves",
        "least_squares",
        "calibration",
        "differences",
        "sensitivity",
        "fractiles",
        "fragility_of_sweep",
        "needed_gaps",
        "propagation",
        "optimum",
    ),
    "sweep": (
        "study",
        "execution",
        "plan",
        "table",
        "session",
        "points",
        "ida",
        "calibrate",
        "demands",
        "uncertainty",
        "optimize",
    ),
    "driver": (
        "request",
        "record_card",
        "identity",
        "outputs",
        "overrides",
        "reading",
        "loading",
        "preflight",
        "prepare",
        "sequence",
        "run",
    ),
}
#: who may import a library, as paths below the two packages
ONLY_IN = {
    "lark": {"cards.py"},
    "h5py": {
        "results/reader.py",
        "results/writer.py",
        "results/whole_file.py",
        "results/vtkhdf.py",
        "results/sweep_file.py",
    },
    "distributed": {"sweep/execution/executors.py"},
    "tabulate": {"report/text.py"},
    "matplotlib": {"report/plot/style.py"},
    "pandas": {"results/frames.py", "results/reader.py", "results/sweep_file.py"},
    "xarray": {"results/frames.py", "results/reader.py", "results/sweep_file.py"},
    "plotly": {"report/html/__init__.py"},
    "numba": {"numerics/jit.py", "numerics/addressed.py"},
    "platformdirs": {"numerics/kernel_cache.py"},
    "pygls": {"editor/server.py"},
    "lsprotocol": {"editor/server.py"},
}
#: layers and modules that read no file and print nothing
NUMERICS = (
    "numerics",
    "statistics/fragility",
    "statistics/separation",
    "statistics/incremental",
    "laws",
    "structure",
    "integrate",
    "analyses",
    "loading/motions",
    "loading/forces",
)


#: modules that read files of the program, or of the system, whole; those of a user go through
#: `pound_deck.files`, which refuses pipes and devices
OF_THE_PROGRAM = {
    "cards.py",
    "messages.py",
    "numerics/digest.py",
    "sweep/execution/limits.py",
    "report/html/__init__.py",
    "report/plot/pictures/animation.py",
    "cli/verbs/example.py",
}
DISPLAYS = (ast.List, ast.Dict, ast.Set, ast.ListComp, ast.DictComp, ast.SetComp)
#: methods that change a value in place
CHANGING = {"append", "add", "update", "pop", "setdefault", "extend", "clear"}


def modules():
    return [p for package in (DECK, IMPORT, SOLVER) for p in package.rglob("*.py")]


def place(path):
    return path.relative_to(next(p for p in (DECK, IMPORT, SOLVER) if path.is_relative_to(p))).as_posix()


class Facts(NamedTuple):
    """What the rules ask of a module's source."""

    imported: set[str]  # dotted names, within functions too
    called: set[str]  # functions that are called by a plain name
    changed: set[str]  # names whose values are changed in place
    displays: list[str]  # names at module level of lists, dictionaries and sets
    has_global: bool  # a function sets a name of its module


@cache
def facts(path):
    """The facts of a module, whose source is parsed once for all rules."""
    module = ast.parse(path.read_text(encoding="utf-8"))
    out = Facts(set(), set(), set(), [], any(isinstance(n, ast.Global) for n in ast.walk(module)))
    for node in ast.walk(module):
        match node:
            case ast.Import(names):
                out.imported.update(a.name for a in names)
            case ast.ImportFrom(str(source), names):
                out.imported.update(f"{source}.{a.name}" for a in names)
            case ast.Call(ast.Name(name)):
                out.called.add(name)
            case ast.Call(ast.Attribute(ast.Name(name), method)) if method in CHANGING:
                out.changed.add(name)
    for node in module.body:
        match node:
            case ast.Assign(targets, value) if isinstance(value, DISPLAYS):
                out.displays.extend(t.id for t in targets if isinstance(t, ast.Name))
            case ast.AnnAssign(ast.Name(name), _, value) if isinstance(value, DISPLAYS):
                out.displays.append(name)
    return out


def imported(path):
    return facts(path).imported


def layer(dotted):
    """The first folder or module below ``pound_solve``."""
    words = dotted.split(".")
    return words[1] if len(words) > 1 and words[1] in LAYERS else "__init__"


def test_files_of_a_user_are_read_in_one_way():
    reading = {
        place(path)
        for path in modules()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Attribute) and node.attr in ("read_text", "read_bytes")
    }
    assert reading == OF_THE_PROGRAM


def test_the_parser_knows_nothing_of_the_solver_nor_of_numbers():
    allowed = set(sys.stdlib_module_names) | {"lark", "pound_deck"}
    for path in DECK.rglob("*.py"):
        assert {name.split(".")[0] for name in imported(path)} <= allowed, path


def test_models_of_others_are_read_with_the_parts_of_the_parser_that_hold_no_grammar():
    allowed = {f"pound_deck.{name}" for name in ("diagnostics", "files", "model", "schema", "source")}
    for path in IMPORT.rglob("*.py"):
        for name in imported(path):
            package = name.split(".")[0]
            own = package in sys.stdlib_module_names or package == "pound_import"
            assert own or name.rpartition(".")[0] in allowed or name in allowed, f"{path}: {name}"


def test_only_the_driver_and_the_verb_read_models_of_others():
    users = {
        place(p) for p in SOLVER.rglob("*.py") if any(n.startswith("pound_import") for n in imported(p))
    }
    drivers = {f"driver/{name}.py" for name in ("importing", "reading", "record_format")}
    assert users == drivers | {"cli/verbs/import.py"}


@pytest.mark.parametrize("library", ONLY_IN)
def test_each_library_has_one_door(library):
    users = {place(p) for p in modules() if any(n.split(".")[0] == library for n in imported(p))}
    assert users <= ONLY_IN[library]


def test_the_solver_takes_the_model_from_the_parser_and_only_the_top_reads_decks():
    for path in SOLVER.rglob("*.py"):
        taken = {n.split(".")[1] for n in imported(path) if n.startswith("pound_deck.")}
        allowed = {"model", "schema", "diagnostics", "messages", "files"}
        if place(path).startswith(("driver/", "cli/", "assess/", "sweep/")):
            allowed |= {"reader"}
        if place(path) == "sweep/optimize.py":
            allowed |= {"formula", "revise"}
        if place(path).startswith("cli/"):
            allowed |= {"layout"}
        if place(path).startswith("editor/"):  # half a deck is read stage by stage
            allowed = {p.stem for p in DECK.glob("*.py")}
        if place(path) in ("report/listing.py", "report/machine_readable.py"):
            allowed |= {"sections"}
        assert taken <= allowed, path


def test_every_layer_is_known_and_few_modules_lie_outside_of_layers():
    flat = {p.stem for p in SOLVER.glob("*.py")}
    assert flat == {
        "__init__",
        "__main__",
        "catalog",
        "check",
        "deck",
        "interruption",
        "user_error",
        "modules",
        "version",
    }
    assert {p.name for p in SOLVER.iterdir() if (p / "__init__.py").is_file()} == set(LAYERS) - flat


def test_imports_go_down():
    for path in SOLVER.rglob("*.py"):
        own = path.relative_to(SOLVER).parts[0].removesuffix(".py")
        for name in imported(path):
            if name.startswith("pound_solve"):
                assert LAYERS.index(layer(name)) <= LAYERS.index(own), f"{place(path)} imports {name}"


def test_no_modules_import_each_other_in_a_circle():
    files = {".".join(p.relative_to(SOLVER.parent).with_suffix("").parts): p for p in SOLVER.rglob("*.py")}
    needs = {
        name: {module for n in imported(p) for module in (n, n.rpartition(".")[0]) if module in files}
        - {name}
        for name, p in files.items()
    }
    TopologicalSorter(needs).prepare()  # CycleError names the circle


@pytest.mark.parametrize("name", WITHIN)
def test_imports_go_down_within_a_layer(name):
    order = WITHIN[name]
    for path in (SOLVER / name).rglob("*.py"):
        own = path.relative_to(SOLVER / name).parts[0].removesuffix(".py")
        for dotted in imported(path) if own in order else ():
            words = dotted.split(".")
            if words[:2] == ["pound_solve", name] and len(words) > 2 and words[2] in order:
                assert order.index(words[2]) <= order.index(own), f"{place(path)} imports {dotted}"


@pytest.mark.parametrize("name", [x for x in LAYERS if (SOLVER / x).is_dir()])
def test_parts_of_a_layer_import_each_other_one_way(name):
    """Files and folders of a layer, each folder as one part."""
    needs = {}
    for path in (SOLVER / name).rglob("*.py"):
        part = path.relative_to(SOLVER / name).parts[0].removesuffix(".py")
        words = [dotted.split(".") for dotted in imported(path)]
        inside = {w[2] for w in words if w[:2] == ["pound_solve", name] and len(w) > 2}
        parts = {p.name.removesuffix(".py") for p in (SOLVER / name).iterdir()}
        needs.setdefault(part, set()).update(inside & parts - {part})
    needs.pop("__init__", None)
    TopologicalSorter(needs).prepare()  # CycleError names the circle


#: names of one word that say what they return, or that the field knows
OF_ONE_WORD = {
    "advance", "allocate", "basis", "buffers", "copy", "dot", "earlier", "energy", "highest", "integrate",
    "layout", "limit", "march", "monomials", "multiply", "none", "overlap", "places", "pole", "product",
    "room", "size", "slopes", "value",
}  # fmt: skip


@pytest.mark.parametrize("folder", ["events", "kernels", "series", "stepping"])
def test_names_of_kernels_say_what_they_do_with_what(folder):
    for path in (SOLVER / "integrate" / folder).glob("*.py"):
        tree = ast.parse(path.read_text("utf-8"))
        functions = [x.name for x in tree.body if isinstance(x, ast.FunctionDef)]
        assert not [x for x in functions if "_" not in x and x not in OF_ONE_WORD], place(path)


SAYS_NOTHING = {"own", "found"}  #: names that variables and parameters had before they said what they hold


def names_within(function):
    """Parameters and variables of a function, and of those within it."""
    yield from (x.arg for x in ast.walk(function) if isinstance(x, ast.arg))
    for x in ast.walk(function):
        if isinstance(x, ast.Name) and isinstance(x.ctx, ast.Store):
            yield x.id


def test_variables_say_what_they_hold():
    for path in modules():
        functions = [
            x for x in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(x, ast.FunctionDef)
        ]
        for f in functions:
            names = SAYS_NOTHING & set(names_within(f))
            assert not names, f"{place(path)}: {names} in {f.name} say nothing"


#: names that fields of the engines had in two to five meanings each
AMBIGUOUS = {"held", "number", "numbers", "place", "present", "rest"}


def test_fields_of_the_engines_have_names_with_one_meaning():
    for path in (SOLVER / "integrate").rglob("*.py"):
        for record in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(record, ast.ClassDef):
                fields = {x.target.id for x in record.body if isinstance(x, ast.AnnAssign)}
                assert not fields & AMBIGUOUS, f"{place(path)}: {record.name}"


def test_no_two_classes_have_one_name():
    names = [
        (x.name, place(path))
        for path in modules()
        for x in ast.parse(path.read_text("utf-8")).body
        if isinstance(x, ast.ClassDef)
    ]
    first = dict(reversed(names))
    twice = [(name, where, first[name]) for name, where in names if where != first[name]]
    assert not twice


def names_below(node):
    """Names, attributes and functions within a node."""
    for x in ast.walk(node):
        if isinstance(x, ast.Name | ast.Attribute):
            yield x.id if isinstance(x, ast.Name) else x.attr
        elif isinstance(x, ast.FunctionDef):
            yield x.name


def test_attributes_that_docstrings_and_comments_name_are_there():
    texts = {path: path.read_text("utf-8") for path in modules()}
    nodes = (x for text in texts.values() for x in ast.walk(ast.parse(text)))
    classes = {x.name: set(names_below(x)) for x in nodes if isinstance(x, ast.ClassDef)}
    for path, text in texts.items():
        for name, attribute in re.findall(r"(?<![`:])`([A-Z][a-z]\w+)\.(\w+)`", text):
            assert attribute in classes.get(name, ()), f"{place(path)}: {name}.{attribute} is not there"


def test_numerics_open_no_file_and_print_nothing():
    for path in SOLVER.rglob("*.py"):
        if place(path).startswith(NUMERICS) and path.name != "jit.py":
            assert not facts(path).called & {"open", "print", "input"}, path


def test_no_module_keeps_mutable_state():
    """A display at module level is a constant, in capitals, that is never changed in place."""
    for path in modules():
        own = facts(path)
        assert not own.has_global, path
        assert all(name.isupper() for name in own.displays), f"{path}: {own.displays}"
        assert not own.changed & set(own.displays), path


def test_no_function_evaluates_text():
    for path in modules():
        assert not facts(path).called & {"eval", "exec"}, path


def test_functions_fit_on_a_page():
    """No function has more than sixty lines without its docstring, and none is called by a word that says
    nothing; ruff holds their complexity and the number of their parameters.
    """
    for path in modules():
        for x in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(x, ast.FunctionDef):
                docstring = x.body[0] if ast.get_docstring(x) is not None else None
                lines = docstring.end_lineno - docstring.lineno + 1 if docstring else 0
                assert x.end_lineno - x.lineno + 1 - lines <= 60, f"{place(path)}: {x.name}"
                assert x.name not in SAYS_NOTHING, f"{place(path)}: {x.name}"


def raised_in(docstring):
    """Names in the section Raises of a docstring."""
    section = re.search(r"^Raises\n-+\n((?:.+\n?)+)", docstring or "", re.M)
    entries = re.findall(r"^[\w., ]+$", section.group(1), re.M) if section else []
    return [name for entry in entries if not entry.startswith(" ") for name in entry.split(", ")]


def test_exceptions_in_docstrings_exist():
    trees = {path: ast.parse(path.read_text("utf-8")) for path in modules()}
    classes = {x.name for tree in trees.values() for x in ast.walk(tree) if isinstance(x, ast.ClassDef)}
    documented = [
        (place(path), name)
        for path, tree in trees.items()
        for x in ast.walk(tree)
        if isinstance(x, ast.FunctionDef | ast.ClassDef)
        for name in raised_in(ast.get_docstring(x))
    ]
    assert len(documented) > 200
    known = classes | set(dir(builtins)) | {"numpy.linalg.LinAlgError"}
    assert not [(path, name) for path, name in documented if name not in known]

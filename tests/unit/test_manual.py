"""The manual is true: links lead somewhere, numbers are the code's, the developer guide's examples run."""

import importlib
import math
import os
import re
import shutil
import subprocess
import sys
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import contract
import manual_pages
from decks import model_of, solved
from kernels import interpreted
from pound_solve import run
from pound_solve.catalog import catalog, members, specs
from pound_solve.driver.run import Request, prepare
from pound_solve.laws.contact import restitution
from pound_solve.structure.assembly import AssemblyError, assemble
from unit import test_damper_contract

ROOT = Path(__file__).parents[2]
MANUAL = ROOT / "manual"
GUIDE, ARCHITECTURE, GLOSSARY = (
    (MANUAL / page).read_text("utf-8") for page in ("developer-guide.md", "architecture.md", "glossary.md")
)
PAGES = sorted([*MANUAL.glob("*.md"), ROOT / "README.md", *(ROOT / "examples").rglob("README.md")])

# ---------------------------------------------------------------- parts that the program makes


@pytest.mark.parametrize("name", manual_pages.PARTS)
def test_parts_made_from_tables_of_the_program_are_fresh(name):
    page, _ = manual_pages.PARTS[name]
    assert (MANUAL / page).read_text("utf-8") == manual_pages.renewed(name), (
        f"tests/refresh_manual.py {name}"
    )


# ---------------------------------------------------------------- links


def prose(page):
    """Text of a page without its code blocks."""
    return re.sub(r"^(```|~~~).*?^\1", "", page.read_text("utf-8"), flags=re.M | re.S)


def anchors(page):
    """Names that the headings of a page have on a repository page."""
    out = set()
    for head in re.findall(r"^#+ +(.*)$", prose(page), re.M):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", head).lower()
        name = base = re.sub(r"[^\w\- ]", "", plain).replace(" ", "-")
        n = 0
        while name in out:  # the second heading of a name gets a number
            n += 1
            name = f"{base}-{n}"
        out.add(name)
    return out


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_every_relative_link_leads_somewhere(page):
    dead = []
    for link in re.findall(r"\]\(([^)\s]+)\)", prose(page)):
        if re.match(r"[a-z]+:", link):
            continue
        file, _, anchor = link.partition("#")
        target = (page.parent / file) if file else page
        if not target.exists() or (anchor and anchor not in anchors(target)):
            dead.append(link)
    assert not dead


def test_every_path_that_the_developer_guide_names_is_there():
    text = prose(MANUAL / "developer-guide.md")
    named = re.findall(r"`((?:tests|solver|parser|manual|benchmarks)/[\w./-]+)`", text)
    assert len(named) > 10
    assert not [p for p in named if not (ROOT / p).exists() and "CODE" not in p]


@pytest.mark.parametrize("package", ["parser/pound_deck", "parser/pound_import", "solver/pound_solve"])
def test_every_module_is_on_the_map_of_the_architecture(package):
    table_of_places = ARCHITECTURE.split("## Three walks")[0]
    here = (ROOT / package).iterdir()
    names = {p.stem for p in here if p.suffix == ".py" or (p / "__init__.py").exists()}
    assert not [x for x in names if not x.startswith("__") and f"`{x}`" not in table_of_places]


def rows_of(page):
    """Cells of the rows of all tables of a page, but for their heads."""
    rows = [line.strip("| ").split(" | ") for line in page.splitlines() if line.startswith("| ")]
    return [row for row in rows if row[0] not in ("file", "layer, from the top down", "term")]


def text_of(path):
    """Text of a file that a page names: below the solver, unless it begins with the parser."""
    return (ROOT / ("" if path.startswith("parser/") else "solver/pound_solve") / path).read_text("utf-8")


def defines(text, name):
    """Whether a module defines a function, class or constant."""
    return re.search(rf"^ *(?:def|class) {name}\b|^{name}\b.*?(?:=|:)", text, re.M) is not None


def test_the_walks_lead_along_functions_that_are_there():
    walks = [row for row in rows_of(ARCHITECTURE) if row[0].strip("`").endswith(".py")]
    assert len(walks) > 25
    assert not [w for w in walks if not defines(text_of(w[0].strip("`")), w[1].strip("`"))]


def test_the_glossary_is_in_order_and_its_places_are_there():
    named = set()
    for group in GLOSSARY.split("\n## ")[1:]:
        rows = rows_of(group)
        terms = [row[0].lower() for row in rows]
        assert len(terms) > 10 and terms == sorted(terms)
        for _, _, places in rows:
            path = ""
            for place in re.findall(r"`([^`]+)`", places):
                if place.endswith(".py"):
                    path = place
                    text = text_of(path)
                else:
                    assert defines(text, place), (path, place)
                    named.add((path, place))
    for module in ("kernels/state", "kernels/law_state", "kernels/sparse", "series/state"):
        path = f"integrate/{module}.py"
        classes = re.findall(r"^class (\w+)", text_of(path), re.M)
        assert not [name for name in classes if (path, name) not in named]


#: what plain English says otherwise; regular expressions of phrases that the pages got rid of
GONE = (
    r"^Where\b", r"\bis not to be had\b", r"\breckoned with\b", r"\blest\b", r"\bwhat is more\b",
    r"\b(?:is|are|was) told by\b", r"\blooked at\b", r"\blooked for\b", r"\blittle by little\b",
    r"\bcomes? to lose\b", r"\bgiven up for\b", r"\bNone is made\b", r"\bdoes without\b",
    r"\btells? of\b", r"\bdear(?:er|est)?\b", r"\bElse[,:]", r"\bOf several\b", r"\bstands? for one\b",
    r"\bknown to us\b", r"\b(?:is|are) to be (?:had|seen|found)\b",
    r"taken off the beam", r"does not suffice", r"has none of that name", r"that it looks at",
    r"tells what there is", r"stands like no other", r"as far as that can be told",
    r"knows its (?:head|tables)", r"something else moves", r"is meant to\.", r"ride on the ground",
    r"turned further than",
)  # fmt: skip
#: their texts come from the source
COLE = {f"cole2011-{name}.md" for name in ("study", "annex", "readings")}
GENERATED = {"messages.md", "deck-reference.md", *COLE}


@pytest.mark.parametrize("phrase", GONE)
def test_the_pages_are_in_plain_english(phrase):
    pages = [p for p in (*MANUAL.glob("*.md"), ROOT / "README.md") if p.name not in GENERATED]
    assert len(pages) > 20
    found = [(p.name, m[0]) for p in pages for m in re.finditer(phrase, prose(p), re.M)]
    assert not found


#: and of phrases that messages, docstrings and comments got rid of
GONE_FROM_SOURCE = (
    r"\bin no time\b", r"\bstands twice\b", r"\bis none of\b", r"\bmeans it so\b", r"\bby their numbers\b",
    r"\bis no part of\b", r"\bwhere it stands\b", r"[a-z] -{6,} [A-Z]",
)  # fmt: skip


@pytest.mark.parametrize("phrase", GONE_FROM_SOURCE)
def test_the_source_is_in_plain_english(phrase):
    modules = [p for room in ("solver", "parser") for p in (ROOT / room).rglob("*.py")]
    assert len(modules) > 300
    assert not [p.name for p in modules if re.search(phrase, p.read_text("utf-8"))]


def test_formulas_are_closed():
    for page in (*MANUAL.glob("theory-*.md"), MANUAL / "hysteresis.md"):
        text = prose(page)
        assert text.count("$$") % 2 == 0, page
        for paragraph in re.split(r"\n\s*\n", re.sub(r"\$\$.*?\$\$", "", text, flags=re.S)):
            assert paragraph.count("$") % 2 == 0, paragraph
            # an unescaped bar within a formula would end a cell
            for row in re.findall(r"^\|.*", paragraph, re.M):
                assert not [formula for formula in re.findall(r"\$[^$]*\$", row) if "|" in formula]


# ---------------------------------------------------------------- what the pages name

#: where each family is explained
HOME = {
    "element": ("theory-structure.md", "theory-members.md"),
    "hysteresis": ("hysteresis.md",),
    "contact": ("theory-contact.md",),
    "damping": ("theory-damping.md",),
    "damper": ("theory-damping.md",),
    "analysis": ("theory-structure.md", "theory-static.md", "theory-integration.md"),
    "method": ("theory-integration.md",),
    "motion": ("records.md",),
    "force": ("records.md",),
    "record": ("records.md",),
}


@pytest.mark.parametrize("spec", specs(), ids=lambda s: f"{s.family}-{s.name}")
def test_every_member_of_the_catalog_is_explained(spec):
    text = "\n".join((MANUAL / page).read_text("utf-8") for page in HOME[spec.family])
    # as code, in bold or in a heading: a word in passing explains nothing
    assert re.search(rf"`{spec.name}`|\*\*{spec.name}\*\*|^#+ .*\b{spec.name}\b", text, re.M)


def test_dependencies_are_those_of_the_package():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    asked = [*project["project"]["dependencies"], *project["build-system"]["requires"]]
    asked += [x for extra in project["project"]["optional-dependencies"].values() for x in extra]
    names = {re.match(r"[\w-]+", x)[0] for x in asked} - {"pound-solve"}  # an extra of its own
    page = (MANUAL / "dependencies.md").read_text("utf-8")
    assert set(re.findall(r"^\| (?:`\w+` \| )?`([\w-]+)` \|", page, re.M)) == names


# ---------------------------------------------------------------- numbers


def table(page, name):
    """Rows of a marked table of the manual, as texts without code marks."""
    body = (MANUAL / page).read_text("utf-8").split(f"<!-- table: {name} -->")[1].split("<!-- end -->")[0]
    rows = [line.strip("| ").split(" | ") for line in body.strip().splitlines()[2:]]
    assert rows
    return [[cell.strip("` ") for cell in row] for row in rows]


RESTITUTION = table("theory-contact.md", "restitution")


@pytest.mark.parametrize("row", RESTITUTION, ids=lambda r: r[0])
def test_table_of_restitution_is_that_of_the_relations(row):
    e = float(row[0])
    with_tension, without = restitution.with_tension_ratio(e), restitution.no_tension_ratio(e)
    recovered = restitution.no_tension(with_tension)
    assert row[1:] == [f"{with_tension:.5f}", f"{without:.5f}", f"{recovered:.4f}"]
    assert restitution.with_tension(with_tension) == pytest.approx(e, rel=1e-13)
    assert restitution.no_tension(without) == pytest.approx(e, rel=1e-13)


def test_table_of_published_relations_is_what_the_laws_say():
    head = (MANUAL / "theory-contact.md").read_text("utf-8").split("<!-- table: published -->")[1]
    names = re.findall(r"`(\w+)`", head.strip().splitlines()[0])
    for row in table("theory-contact.md", "published"):
        for name, cell in zip(names, row[1:], strict=True):
            spec = next(s for s in specs() if (s.family, s.name) == ("contact", name))
            values = {f.name: f.default for f in spec.fields}
            values |= {"GAP": 0.0, "K": 1.0, "E": float(row[0]), "RELATION": "PUBLISHED"}
            assert f"{spec.impl(values, 1.0).e_given:.4f}" == cell, name


IMPACT = """UNITS kN m s
PARAM e = 0.5
NODES
   1  0 0  FIX=YR
   2  1 0  FIX=YR
ELEMENTS
   1  HIT 1 2
PROPS
   HIT CONTACT GAP=0.01 LAW=KELVIN_VOIGT K=1E5 E=e RELATION=PUBLISHED
WEIGHTS
   1  981
   2  490.5
INITIAL
   1  VX=1
ANALYSIS
   HISTORY 0.5 METHOD=EXACT
OUTPUT
   EVERY=0.25
"""


@pytest.mark.full
@pytest.mark.parametrize("row", RESTITUTION, ids=lambda r: r[0])
def test_table_of_restitution_is_met_by_collisions_of_free_masses(row, tmp_path):
    deck = tmp_path / "impact.inp"
    deck.write_text(IMPACT)
    with run(deck, {"e": row[0]}) as results:
        (hit,) = results.table("collisions")
        assert f"{hit['restitution']:.4f}" == row[3]
        (law,) = results.table("contact_laws")
        assert hit["restitution"] == pytest.approx(law["e_given"], rel=1e-10)


def test_release_leaves_the_overlap_and_the_loss_of_the_manual():
    # by the closed motion itself, not by the program
    for xi in (0.05, 0.3, 0.7, 0.95):
        root = math.sqrt(1 - xi * xi)
        t = 2 * math.acos(xi) / root  # omega = v0 = m = 1
        decay = math.exp(-xi * t)
        overlap = decay * math.sin(root * t) / root
        rate = decay * (math.cos(root * t) - xi / root * math.sin(root * t))
        e = restitution.no_tension(xi)
        assert -rate == pytest.approx(e, rel=1e-13)
        assert overlap == pytest.approx(2 * xi * e, rel=1e-12)
        assert overlap + 2 * xi * rate == pytest.approx(0.0, abs=1e-14)


def test_constants_are_those_of_the_code():
    for _, where, value in table("theory-integration.md", "constants"):
        module, name = where.rsplit(".", 1)
        home = importlib.import_module(f"pound_solve.integrate.{module}")
        assert getattr(home, name) == float(value), where


@pytest.mark.full
def test_table_of_convergence_is_what_the_methods_do(tmp_path):
    text = (MANUAL / "theory-integration.md").read_text("utf-8")
    deck = tmp_path / "wall.inp"
    deck.write_text(re.search(r"^```\n(TITLE.*?)^```", text, re.M | re.S)[1])

    def force(**how):
        with run(deck, **how) as results:
            (wall,) = results.table("contact_summary")
            assert wall["closures"] == 1
            return wall["peak_force"]

    exact = force(method="EXACT")
    rows = table("theory-integration.md", "convergence")
    for n, method in enumerate(("NEWMARK", "HHT", "GENERALISED_ALPHA", "CENTRAL"), 1):
        errors = [abs(force(method=method, dt=float(row[0])) / exact - 1) for row in rows]
        assert errors == pytest.approx([float(row[n]) for row in rows], rel=0.01)
        order = math.log(errors[0] / errors[1]) / math.log(float(rows[0][0]) / float(rows[1][0]))
        assert order == pytest.approx(2.0, abs=0.2 if method == "HHT" else 0.05)


@pytest.mark.slow
def test_table_of_taylor_is_what_it_does(tmp_path):
    """The same series and events; differences to EXACT, which are rounding, up to ten times the table's."""
    rows = table("theory-integration.md", "taylor")
    for name, unknowns, series, in_modes, events, drifts, forces in rows[:3]:
        deck, _, n = name.partition(" n=")
        found = []
        for method in ("EXACT", "TAYLOR"):
            where = MANUAL.parent / "examples" / "cole2011" / deck
            with run(where, params={"n": n} if n else {}, out=tmp_path / method, method=method) as results:
                envelope, contacts = results.table("drift_envelope"), results.table("contact_summary")
                figures = dict(results.table("run").tolist())
                extremes = np.array([envelope["max"], envelope["min"]])
                found.append((extremes, contacts["peak_force"]))
        assert (figures["unknowns"], figures["events"]) == (unknowns, events)
        assert int(figures["series"]) == pytest.approx(int(series), rel=0.01)
        assert int(figures.get("intervals in modes", 0)) == pytest.approx(int(in_modes), rel=0.01)
        (drift, force), (other, peak) = found
        assert (np.abs(other - drift).max(axis=0) / np.abs(drift).max(axis=0)).max() < 10 * float(drifts)
        assert (np.abs(peak - force) / force).max() < 10 * float(forces)


# ---------------------------------------------------------------- the developer guide's examples

EXAMPLES = dict(re.findall(r"<!-- file: (\S+) -->\n\n```python\n(.*?)```", GUIDE, re.S))


@pytest.fixture
def extended(tmp_path, monkeypatch):
    """The program with the example files in its family folders, and nothing else changed.

    Kernels run as Python: a library compiled ahead of time does not know the examples.
    """
    names = []
    for file, code in EXAMPLES.items():
        *folders, module = file.removesuffix(".py").split("/")
        package = importlib.import_module(f"pound_solve.{'.'.join(folders)}")
        own = tmp_path.joinpath("families", *folders)
        own.mkdir(parents=True)
        (own / f"{module}.py").write_text(code, "utf-8")
        monkeypatch.setattr(package, "__path__", [*package.__path__, str(own)])
        names.append((package, module))
    importlib.invalidate_caches()
    members.cache_clear()
    with interpreted():
        yield tmp_path
    members.cache_clear()
    for package, module in names:
        sys.modules.pop(f"{package.__name__}.{module}", None)
        if hasattr(package, module):
            delattr(package, module)


def test_the_example_rule_keeps_the_contract(extended):
    module = importlib.import_module("pound_solve.laws.hysteresis.stiffening")
    for s in (1.0, 4.0):
        law = module.build({"S": s}, 100.0, 2.0, -1.0)
        assert contract.keep(law, 0.1) == {"soft", "stiff +", "stiff -"}


ROCKING = """UNITS kN m s
NODES
   1  0 0  FIX=XYR
   2  0 3  FIX=YR
ELEMENTS
   1  WALL 1 2
PROPS
   WALL SPRING KX=100 FX=10 RULE=STIFFENING S=4
WEIGHTS
   2  9.81
INITIAL
   2  VX=3
DRIFT
   "wall" 1 2
ANALYSIS
   HISTORY 2
"""


@pytest.mark.full
def test_the_example_rule_works_in_a_deck(extended):
    deck = extended / "rocking.inp"
    deck.write_text(ROCKING)
    # m = 1: from the limit at 0.1 on, energy 4.5 - 0.5 = 10 x + 200 x^2; each phase is a sine of its own
    peak = 0.1 + (math.sqrt(3300.0) - 10.0) / 400.0
    v1, w1 = math.sqrt(8.0), 20.0
    t_peak = math.asin(1 / 3) / 10 + math.atan2(v1 / w1, 10.0 / 400.0) / w1
    for how, tol in (({}, 1e-12), ({"method": "NEWMARK", "dt": 1e-3}, 1e-5)):
        with run(deck, **how) as results:
            assert results.status == "done"
            (drift,) = results.table("drift_envelope")
            assert drift["max"] == pytest.approx(peak, rel=tol)
            assert drift["min"] == pytest.approx(-peak, rel=tol)
            assert drift["t_max"] % (4 * t_peak) == pytest.approx(t_peak, rel=100 * math.sqrt(tol))
            energy = {row[0]: row["value"] for row in results.table("energy")}
            assert energy["hysteretic"] == 0.0
            assert abs(energy["residual"]) <= 4.5 * tol


def test_the_example_contact_works_in_a_deck(extended):
    deck = extended / "slab.inp"
    law = "LAW=SLAB_END EA=1E6 LENGTH=4"
    deck.write_text(re.sub(r"LAW=.*", law, IMPACT))
    with run(deck) as results:
        (hit,) = results.table("collisions")
        reduced = 100 * 50 / 150
        assert hit["restitution"] == pytest.approx(1.0, rel=1e-12)
        assert hit["peak_force"] == pytest.approx(math.sqrt(1e6 / 4 * reduced), rel=1e-12)


@pytest.mark.slow
def test_the_example_damper_keeps_the_contract(extended):
    """By every method the same force, which is linear in the rate beyond the valve."""
    spec = catalog().family("damper")["TWO_STAGE"]
    test_damper_contract.keep(test_damper_contract.law_of(spec))
    forces = []
    for method, tol in (("EXACT", 1e-12), ("TAYLOR", 1e-12), ("NEWMARK DT=5E-4", 2e-5)):
        r = test_damper_contract.shaken(spec, method)
        test_damper_contract.balanced(r, tol)
        (force,) = (x for x in r.tables["spring_envelope"] if x["element"] == 2)
        forces.append([force["force_max"], force["force_min"]])
        speed = np.abs(r.v[:, r.nodes.index(2), 0]).max()
        assert max(np.abs(forces[-1])) == pytest.approx(6.0 + 6.0 * (speed - 0.1), rel=1e-3)
    assert np.abs(np.array(forces) - forces[0]).max() < 1e-3 * np.abs(forces[0]).max()
    assert np.abs(np.array(forces[1]) - forces[0]).max() < 1e-10 * np.abs(forces[0]).max()
    # CENTRAL sees its dashpots, and keeps its order; without that an error falls by half only
    exact, long, short = (
        test_damper_contract.shaken(spec, method, 0.01).u
        for method in ("EXACT", "CENTRAL DT=0.01", "CENTRAL DT=0.005")
    )
    assert np.abs(long - exact).max() > 3.5 * np.abs(short - exact).max()


LINK = """UNITS kN m s
NODES
   1  0 0  FIX=XYR
   2  3 4  FIX=YR
ELEMENTS
   1  BAR 1 2
PROPS
   BAR LINK K=1000
LOADS
   2  FX=9
"""


def test_the_example_element_works_in_a_deck(extended):
    s = solved(LINK)
    assert s.u[2][0] == pytest.approx(9 / (1000 * 0.6**2), rel=1e-14)
    assert s.force[1, "force"] == pytest.approx(9 / 0.6, rel=1e-14)
    model = model_of(LINK)
    at = replace(model.nodes[2], x=0.0, y=0.0)
    with pytest.raises(AssemblyError) as mistake:
        assemble(replace(model, nodes={**model.nodes, 2: at}))
    assert [d.code for d in mistake.value.diagnostics] == ["P330"]


def test_the_example_record_format_works_in_a_deck(extended):
    (extended / "quake.txt").write_text("STEPPED 0.02\n 0.0 12.0 -34.5\n 50.0\n")
    deck = extended / "record.inp"
    shaken = ROCKING.replace("INITIAL\n   2  VX=3\n", 'EQUAKE\n RECORD "quake.txt"\n')
    deck.write_text(shaken)
    (motion,) = prepare(Request(str(deck))).motions
    assert motion.info["format"] == "STEPPED"
    expected = [0.12, (0.12 - 0.345) / 2, 0.5]
    assert motion.acceleration.value([0.02, 0.03, 0.06]) == pytest.approx(expected, rel=1e-13)


TOTAL = """
import sys
from pound_solve import run
from pound_solve.report.text import render
with run(sys.argv[1]) as results:
    total, apart = results.history("contact/total"), results.history("contact/force")
    assert (total[:, 0] == apart.sum(axis=1)).all()
    (row,) = results.table("contact_total")
    assert (row["contacts"], row["peak"]) == (1, apart.max()) and row["peak"] > 0
    assert results.time[apart[:, 0].argmax()] == row["t_peak"]
    assert "SUM OF ALL CONTACT FORCES" in render(results)
"""


@pytest.mark.full
def test_the_example_table_and_its_history_are_in_the_report(extended):
    """In a copy of the program, in a process of its own: what the results hold is found once."""
    deck, own = extended / "impact.inp", "results/tables/contacts/contact_total.py"
    deck.write_text(IMPACT.replace("EVERY=0.25", "EVERY=1E-4"))
    copied = [
        shutil.copytree(ROOT / package, extended / package, ignore=shutil.ignore_patterns("__pycache__"))
        for package in ("solver/pound_solve", "parser/pound_deck", "parser/pound_import")
    ]
    (copied[0] / own).write_text(EXAMPLES[own], "utf-8")
    done = subprocess.run(
        [sys.executable, "-c", TOTAL, str(deck)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(str(p.parent) for p in copied)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr


def test_the_examples_leave_no_trace():
    assert not {"STIFFENING", "SLAB_END", "TWO_STAGE", "LINK", "STEPPED"} & {s.name for s in specs()}

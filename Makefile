# make compare   the main job, some minutes: all policies on ten paths; results in out/compare
# make test      quick tests          make test-slow   the others
# make check     format, lint, types, which room imports which, the documentation's links and tables
# make studies   long studies at full length: coverage, false alarms, claims in 500 worlds, 860 kills
# make bench     speed, beside simpy's
# make mutants   whether tests fail when the code is made wrong on purpose (docs/mutants.md)
# make docs      generated parts of the documentation, and its site in out/site
# make pictures  pictures of pages in the documentation, with Chromium; captions are held to its record
# make reproduction  the papers' experiments, and docs/reproduction.md from them
# make validation  measure this machine with OpenGL, and write what docs/validation.md reports
#
# Everything happens in .venv, made from the first Python >= 3.11 found, or from PYTHON=...

PYTHON =
PYTEST_FLAGS =
PYTHONS = $(PYTHON) python3.13 python3.12 python3.11 python3 python
BIN = .venv/bin
ROOMS = base models traces policies sim render analysis testing cli

.PHONY: compare test test-slow studies check bench mutants docs pictures validation reproduction clean
.DELETE_ON_ERROR:

compare: .venv/.installed
	$(BIN)/lodbench compare --out out/compare

test: .venv/.installed-dev
	$(BIN)/pytest -n auto --dist worksteal -m "not slow" --ignore=tests/benchmarks $(PYTEST_FLAGS)

test-slow: .venv/.installed-dev
	$(BIN)/pytest -n auto -m slow --ignore=tests/benchmarks $(PYTEST_FLAGS)

studies: .venv/.installed-dev
	LODBENCH_STUDIES=full $(BIN)/pytest -n auto -m study -rP $(PYTEST_FLAGS)

check: .venv/.installed-dev
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/pyright
	cd .types && ../$(BIN)/lint-imports ../pyproject.toml --no-cache --no-logo
	$(BIN)/pytest -q tests/test_docs.py -k "not commands_run and not installed"

bench: .venv/.installed-bench
	$(BIN)/pytest tests/benchmarks $(PYTEST_FLAGS)

mutants: .venv/.installed-dev
	$(BIN)/python docs/scripts/mutants.py

docs: .venv/.installed-dev
	$(BIN)/python docs/scripts/build_tables.py
	$(BIN)/python docs/scripts/floors.py
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet
	$(BIN)/pytest -q tests/test_docs.py -k "links or tables"

pictures: .venv/.installed-dev
	$(BIN)/python docs/scripts/pictures.py

reproduction: .venv/.installed-dev
	$(BIN)/lodbench reproduce all --out out/reproduction
	$(BIN)/python docs/scripts/reproduction.py out/reproduction

validation: .venv/.installed-dev
	$(BIN)/python docs/scripts/validation_tables.py
	$(BIN)/python docs/scripts/validation_flicker.py

clean:
	rm -rf .venv .types out build dist lodbench.egg-info .benchmarks .hypothesis
	rm -rf .pytest_cache .ruff_cache

.venv/pyvenv.cfg:
	@for python in $(PYTHONS); do \
	  if "$$python" -c 'import ensurepip, sys, venv; sys.exit(sys.version_info < (3, 11))' \
	      >/dev/null 2>&1; then \
	    echo "$$python -m venv .venv"; exec "$$python" -m venv .venv; \
	  fi; \
	done; \
	echo "error: expected Python 3.11 or later with venv, found none of: $(PYTHONS);" \
	  "install one, or name it: make PYTHON=/path/to/python3" >&2; exit 1

# Analysers resolve the package by these links: its rooms stand side by side at the root.
.venv/.installed: .venv/pyvenv.cfg pyproject.toml
	$(BIN)/python -m pip install --quiet --upgrade "pip>=25.1"
	$(BIN)/python -m pip install -qq --editable .
	rm -rf .types && mkdir -p .types/lodbench
	ln -s $(addprefix ../../,$(ROOMS) $(wildcard lodbench/*.py)) .types/lodbench
	touch $@

.venv/.installed-dev: .venv/.installed
	$(BIN)/python -m pip install -qq --editable ".[dev]"
	touch $@

.venv/.installed-bench: .venv/.installed-dev
	$(BIN)/python -m pip install --quiet --group bench
	touch $@

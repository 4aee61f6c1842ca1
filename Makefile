# `make demo` and `make test` do all their set-up; see CONTRIBUTING.md.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
OUT ?= demo-out

.PHONY: setup demo test check docs gallery bench oracle faults clean

setup: $(VENV)/ready

$(VENV)/ready: requirements-dev.lock pyproject.toml scripts/setup tests/npm/package-lock.json
	PYTHON="$(PYTHON)" scripts/setup $(VENV)
	touch $@

demo: setup
	$(BIN)/litrig demo --out $(OUT)

# What measures the simulators' own times has the machine to itself; all else keeps them also side by side.
ALONE := tests/firmware_sim/camera tests/firmware_sim/udmx $(wildcard tests/firmware_sim/test_*.py)

# One more than there are cores, since many tests wait for wires and processes.
WORKERS = $(shell echo $$(( $$(nproc) + 1 )))

test: setup
	$(BIN)/python -m pytest -n $(WORKERS) --dist worksteal $(ALONE:%=--ignore=%)
	$(BIN)/python -m pytest $(ALONE)

check: setup
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python scripts/command_reference.py --check docs/commands.md

docs: setup
	$(BIN)/python scripts/command_reference.py docs/commands.md

gallery: setup
	$(BIN)/python examples/gallery/make.py docs/pictures

bench: setup
	$(BIN)/python -m benchmarks.run docs/benchmarks.md

oracle: setup
	$(BIN)/python -m benchmarks.oracle docs/oracle.md

faults: setup
	$(BIN)/python -m benchmarks.faults docs/faults.md

clean:
	rm -rf $(VENV) build dist demo-out .mypy_cache .ruff_cache .pytest_cache .import_linter_cache .hypothesis

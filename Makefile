# Two commands on a fresh machine: `make run` and `make test`. Each does all the set-up it needs.

.PHONY: help run test lint bench study screenshots lock setup setup-test
.DEFAULT_GOAL := help

PYTHON ?=
export PYTHON
BIN := .venv/bin
LOCK := --universal --python-version 3.11 --fork-strategy fewest --generate-hashes \
        --no-header --no-annotate --no-emit-index-url --no-emit-find-links --quiet

help: ## Say what each command does
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "make %-12s %s\n", $$1, $$2}' Makefile

run: setup ## Serve the viewer and print its address (ARGS="--port 9000" and the like go to it)
	$(BIN)/umbrage serve $(ARGS)

# Two processes: one computes while the other waits for a browser, a worker or the compiler. In each, linear algebra has
# one thread: those of two processes would wait for each other, and busily.
test: lint ## Lint, types and tests (ARGS go to pytest: "-k name", "-n 0" for one process)
	OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n auto --maxprocesses 2 --no-loadscope-reorder $(ARGS)

lint: setup-test ## Lint and types
	$(BIN)/ruff check .
	$(BIN)/mypy

bench: setup-test ## Frame times per technique and preset, in milliseconds and yardsticks
	$(BIN)/umbrage bench $(ARGS)

study: setup ## Error of every combination of techniques against the reference, with charts
	$(BIN)/umbrage study forest $(ARGS)

screenshots: setup-test ## Pictures of every preset, panel and state of the page, in out/ (ARGS go to it)
	$(BIN)/python -m tests.browser.screenshots $(ARGS)

lock: setup ## Resolve the dependencies anew and write the lock files
	$(BIN)/python -m venv out/lock
	out/lock/bin/pip install --quiet uv
	out/lock/bin/uv pip compile pyproject.toml --extra build $(LOCK) $(ARGS) -o docker/requirements.lock
	out/lock/bin/uv pip compile pyproject.toml --extra build --extra test -c docker/requirements.lock $(LOCK) $(ARGS) \
		-o docker/requirements-test.lock

setup:
	@docker/setup.sh run

setup-test:
	@docker/setup.sh test

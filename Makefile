# `make` alone prints the targets. Everything runs through ./bootstrap, which sets up what is needed.
.DEFAULT_GOAL := help
.PHONY: help demo test lint clean

help: ## print this list
	@sed -n 's/^\([a-z]*\): .*## /  make \1	/p' Makefile

demo: ## run the main example, results in results/slab
	./bootstrap python demos/demo_slab.py --out results/slab

# Both runs are made and reported, whatever the first one gives. On one rank two processes share
# the files.
test: ## run the tests on one and on two ranks
	@one=0; two=0; \
	echo './bootstrap python -m pytest -n 2 --dist loadfile'; \
	./bootstrap python -m pytest -n 2 --dist loadfile || one=$$?; \
	echo './bootstrap mpi 2 -m pytest'; ./bootstrap mpi 2 -m pytest || two=$$?; \
	[ $$one = 0 ] || echo 'make test: FAILED on one rank'; \
	[ $$two = 0 ] || echo 'make test: FAILED on two ranks'; \
	[ $$one = 0 ] && [ $$two = 0 ]

# Ruff and mypy go into .venv where that is the environment; else, so as not to change a
# system's or a user's Python, into a .venv-lint on top of it. mypy's plugin needs pydantic.
lint: ## check style and types
	@set -e; \
	prefix=$$(./bootstrap python -c 'import sys; print(sys.prefix)'); \
	if [ "$$prefix" = "$$(pwd -P)/.venv" ]; then \
	    tools=.venv; \
	else \
	    tools=.venv-lint; \
	    ./bootstrap python -m venv --system-site-packages $$tools; \
	fi; \
	mkdir -p .cache; \
	$$tools/bin/python -c 'import tomllib; \
	    project = tomllib.load(open("pyproject.toml", "rb"))["project"]; \
	    print(*project["optional-dependencies"]["lint"], sep="\n"); \
	    print(*[d for d in project["dependencies"] if d.startswith(("pydantic", "numpy"))], sep="\n")' \
	    > .cache/lint-requirements.txt; \
	$$tools/bin/python -m pip install --quiet --disable-pip-version-check -r .cache/lint-requirements.txt; \
	failed=; \
	$$tools/bin/python -m ruff check || failed="$$failed ruff-check"; \
	$$tools/bin/python -m ruff format --check || failed="$$failed ruff-format"; \
	$$tools/bin/python -m mypy fenics_contact || failed="$$failed mypy"; \
	[ -z "$$failed" ] || { echo "make lint: FAILED:$$failed"; exit 1; }

clean: ## remove results and caches, not the environment
	rm -rf results .hypothesis .pytest_cache .mypy_cache .ruff_cache build *.egg-info
	find . -path './.venv*' -prune -o -name __pycache__ -prune -exec rm -rf {} +

# `make` alone prints the targets. Everything runs through ./bootstrap, which sets up what is needed.
.DEFAULT_GOAL := help
.PHONY: help demo test lint docs publish wheel costs browser clean

help: ## print this list
	@sed -n 's/^\([a-z]*\): .*## /  make \1	/p' Makefile

demo: ## run the main example, results in results/slab
	./bootstrap python demos/demo_slab.py --out results/slab

# Both runs are made and reported, whatever the first one gives. On one rank two processes share
# the files. Both run every test; of the cases of one that has several, two ranks take a quarter,
# and one rank the others. ON_ONE and ON_TWO choose other shares (tests/shares.py).
ON_ONE = --but-one-case-in 4
ON_TWO = --one-case-in 4
on_one = pytest -n 2 --dist loadfile $(ON_ONE)
on_two = pytest $(ON_TWO)
test: ## run the tests on one and on two ranks
	@one=0; two=0; \
	echo './bootstrap python -m $(on_one)'; \
	./bootstrap python -m $(on_one) --ignore=tests/browser || one=$$?; \
	echo './bootstrap mpi 2 -m $(on_two)'; \
	./bootstrap mpi 2 -m $(on_two) --ignore=tests/browser || two=$$?; \
	[ $$one = 0 ] || echo 'make test: FAILED on one rank'; \
	[ $$two = 0 ] || echo 'make test: FAILED on two ranks'; \
	[ $$one = 0 ] && [ $$two = 0 ]

# Tools of an extra of pyproject.toml go into .venv where that is the environment; else, so as not to
# change a system's or a user's Python, into a .venv-EXTRA on top of it. $$tools is where they are.
# mypy's plugin needs pydantic.
define install
set -e; \
	prefix=$$(./bootstrap python -c 'import sys; print(sys.prefix)'); \
	if [ "$$prefix" = "$$(pwd -P)/.venv" ]; then \
	    tools=.venv; \
	else \
	    tools=.venv-$(1); \
	    ./bootstrap python -m venv --system-site-packages $$tools; \
	fi; \
	mkdir -p .cache; \
	$$tools/bin/python -c 'import tomllib; \
	    project = tomllib.load(open("pyproject.toml", "rb"))["project"]; \
	    print(*project["optional-dependencies"]["$(1)"], sep="\n"); \
	    print(*[d for d in project["dependencies"] if d.startswith(("pydantic", "numpy"))], sep="\n")' \
	    > .cache/$(1)-requirements.txt; \
	$$tools/bin/python -m pip install --quiet --disable-pip-version-check -r .cache/$(1)-requirements.txt
endef

lint: ## check style and types
	@$(call install,lint); \
	failed=; \
	$$tools/bin/python -m ruff check || failed="$$failed ruff-check"; \
	$$tools/bin/python -m ruff format --check || failed="$$failed ruff-format"; \
	$$tools/bin/python -m mypy fenics_contact || failed="$$failed mypy"; \
	rm -rf .cache/examples; \
	./bootstrap python docs/examples_as_files.py .cache/examples docs/python_tutorial.md; \
	MYPYPATH=.cache/examples/python_tutorial $$tools/bin/python -m mypy .cache/examples/python_tutorial/*.py \
	    || failed="$$failed examples"; \
	[ -z "$$failed" ] || { echo "make lint: FAILED:$$failed"; exit 1; }

# With the environment of ./bootstrap, by the Python that has the tools.
with_tools = if [ $$tools != .venv ]; then export FENICS_CONTACT_PYTHON=$$tools/bin/python; fi; ./bootstrap python

# Pictures of all demos take minutes; with DRAWN="slab sphere" pages of others have none.
docs: ## build the documentation, into docs/_build/html
	@$(call install,docs); \
	$(with_tools) -m sphinx -E -W --keep-going -q -b html -d docs/_build/doctrees docs docs/_build/html; \
	echo 'docs/_build/html/index.html'

# Of the version AS=...: `latest` is where the site leads to.
AS = latest
publish: ## put the built documentation on the branch gh-pages, and push that
	./bootstrap python distribution/publish.py $(AS) --push

wheel: ## build the wheel, and try it in an empty environment
	./bootstrap python distribution/try_wheel.py

costs: ## measure what docs/solve_cost.md says, and write its tables and picture anew: hours
	./bootstrap python benchmarks/solve_cost.py --plot docs/pictures --page docs/solve_cost.md

browser: ## try reports and the documentation in Chromium
	@$(call install,docs); \
	export FENICS_CONTACT_BROWSER=required; $(with_tools) -m pytest -n 2 --dist loadfile tests/browser

clean: ## remove results and caches, not the environment
	rm -rf results docs/_build docs/cases docs/gallery .hypothesis .pytest_cache .mypy_cache .ruff_cache build *.egg-info
	find . -path './.venv*' -prune -o -name __pycache__ -prune -exec rm -rf {} +

"""How Sphinx builds the documentation: ``make docs``.

Demos are solved and the notebook is executed first, unless nothing they depend on has changed.
Pages fetch nothing from a network: MathJax lies beside them, and fonts are the reader's own.
"""

from __future__ import annotations

import shutil
import sys
import tomllib
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

DOCS = Path(__file__).resolve().parent
ROOT = DOCS.parent
sys.path[:0] = [str(DOCS), str(ROOT)]

# fenics_contact first: it loads FEniCSx in the right order
import fenics_contact  # noqa: E402, F401, I001
import make_cases  # noqa: E402
import make_gallery  # noqa: E402

with (ROOT / "pyproject.toml").open("rb") as _file:
    release = tomllib.load(_file)["project"]["version"]

project = "fenics_contact"
author = "the authors of fenics_contact"
language = "en"

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "sphinx_copybutton",
    "docstrings",
    "repository_files",
]
exclude_patterns = ["_build", "pictures", "problems", "verified"]
nitpicky = True

html_theme = "furo"
html_title = "fenics_contact"
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#1b4f72", "color-brand-content": "#1b4f72"},
    "dark_css_variables": {"color-brand-primary": "#7fb3d5", "color-brand-content": "#7fb3d5"},
}
html_static_path = ["static"]
html_css_files = ["site.css"]
html_extra_path = ["_build/extra"]  # the reports of the demos
html_show_sphinx = False
html_show_copyright = False
html_copy_source = False
html_show_search_summary = False  # which would be fetched; browsers refuse that of files
copybutton_exclude = ".linenos, .gp, .go"

myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
myst_fence_as_directive = ["include", "literalinclude", "figure", "toctree"]

# Results are used again while the cells, the package and the meshes are the same.
nb_execution_mode = "cache"
nb_execution_cache_path = str(DOCS / "_build" / "cells" / make_gallery.fingerprint([])[:16])
nb_execution_timeout = 600  # seconds a cell
nb_execution_raise_on_error = True
nb_merge_streams = True
nb_code_prompt_show = "Show the code"
nb_code_prompt_hide = "Hide the code"

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
napoleon_use_ivar = True
napoleon_use_rtype = False  # "The exit code: 0 …" is no type

# Names in signatures of other projects, whose pages are not asked, as nothing is fetched. Those of
# modules that are not shown: docstrings.py.
nitpick_ignore_regex = [
    (r"py:.*", r"(numpy|np|dolfinx|ufl|basix|petsc4py|PETSc|mpi4py|MPI|scipy|pydantic|NDArray).*"),
    (r"py:.*", "FieldInfo|AllowInfNan|NoneType"),  # in the types of pydantic's fields
    (r"py:.*", r"(argparse|collections|pathlib|types)\..*"),
]
_MATHJAX = "tex-svg-full.js"  # all of it in one file, fonts as well
mathjax_path = f"mathjax/{_MATHJAX}"


def _copy_mathjax(app: Sphinx, exception: Exception | None) -> None:
    """Put MathJax beside the pages."""
    if exception is None and app.builder.format == "html":
        package = find_spec("sphinx-mathjax-offline")
        assert package is not None and package.origin is not None
        source = Path(package.origin).parent / "static" / "mathjax" / _MATHJAX
        target = Path(app.outdir) / "_static" / mathjax_path
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, target)


def _make_pages(app: Sphinx, config: Any) -> None:
    make_cases.make_all()
    make_gallery.make_all()


def setup(app: Sphinx) -> None:
    """Run the demos before pages are read, and bring MathJax along afterwards."""
    app.connect("config-inited", _make_pages)
    app.connect("build-finished", _copy_mathjax)

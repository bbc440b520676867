"""Sphinx: tables made from the code while pages are built."""

from __future__ import annotations

from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective


def setup(app: Sphinx) -> dict[str, Any]:
    """Add the directives."""
    app.add_directive("verification-cases", VerificationCases)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


class VerificationCases(SphinxDirective):
    """The cases of ``fenics-contact verify``, with what each is compared to."""

    def run(self) -> list[nodes.Node]:
        """Render the table."""
        from fenics_contact.verification import CASES

        rows = [f"| `{case.name}` | {case.summary} | {case.source} |" for case in CASES]
        lines = ["| case | what | compared with |", "|---|---|---|", *rows]
        return self.parse_text_to_nodes("\n".join(lines))

"""``report.html``: the page, its tables, its HTML."""

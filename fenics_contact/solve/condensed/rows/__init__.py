"""Numbers that are linear in the displacement of a condensed body: a row for each, made once."""

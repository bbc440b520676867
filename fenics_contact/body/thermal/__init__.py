"""What temperatures do to a body: parts of it expand, by fields that are given."""

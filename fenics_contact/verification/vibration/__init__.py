"""Natural frequencies, and what joints damp."""

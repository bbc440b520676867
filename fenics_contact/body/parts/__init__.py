"""Connected parts of a body, and the parts of it that are tightened."""

"""What of a body hangs together, and the parts of it that are tightened."""

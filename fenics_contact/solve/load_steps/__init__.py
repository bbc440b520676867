"""One load step after the other: their size, what is kept of one, going back."""

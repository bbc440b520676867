"""Pictures along contact surfaces, on them, and below them: the paper's Figs. 2, 9 and 12."""

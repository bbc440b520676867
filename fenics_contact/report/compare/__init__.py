"""The page of several runs side by side: tables, and their curves on each other."""

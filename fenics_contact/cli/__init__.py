"""The command line: its words, and what commands do."""

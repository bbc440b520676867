"""Completion in other programs: scripts for shells, and the schema of scenes for editors."""

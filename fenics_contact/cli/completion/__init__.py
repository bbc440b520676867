"""What other programs complete by: scripts for shells, and the schema of scenes for editors."""

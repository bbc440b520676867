"""Cases of fretting: stresses at the edge of a contact under bulk load, and lives."""

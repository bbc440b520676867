"""The condensed problem of contacts so large that its stiffness S is applied and never written."""

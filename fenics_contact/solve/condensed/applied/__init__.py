"""Bodies whose condensed stiffness is applied by back-substitutions and never formed."""

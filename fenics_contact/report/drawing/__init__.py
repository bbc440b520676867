"""Parts that all pictures share: reading of fields, figures, style, a display for VTK."""

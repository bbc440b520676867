"""What all pictures share: fields that are read, figures, style, a display for VTK."""

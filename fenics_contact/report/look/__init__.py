"""The page of a CAD or mesh file: its bodies and surfaces to click on, and pairs for contacts."""

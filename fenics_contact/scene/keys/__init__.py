"""Reference and schema of scenes, read off their classes; and keys added to these at run time."""

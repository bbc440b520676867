"""Pages in HTML: of a run, of a sweep, of a fit, of several runs, and of a file of geometry."""

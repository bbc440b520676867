"""Help texts of the program and of its commands without a folder of their own."""

from __future__ import annotations

ABOUT = """\
Contact with friction in elastostatics, on FEniCSx: a scene in a file says what the body is, what
holds it, loads it and touches it; the answer comes with checks of the physics and with error bars.
After Campos, Oden and Kikuchi (1982)."""

EXIT_CODES = """\
Exit codes:
  0    converged, and every check passed
  2    bad input, or a scene that has no equilibrium
  3    not converged, or not to the accuracy asked for
  4    converged, but a check of the physics failed
  5    the machine failed: memory, disk, a rank
  130  interrupted; the last load step that was done is kept"""

FIRST = """\
Examples:
  fenics-contact new hertz              # a scene to start from, with its mesh
  fenics-contact look joint.step        # a CAD file as a page, and a scene to complete
  fenics-contact check hertz.toml       # what would be modelled
  fenics-contact run hertz.toml         # solves it
  fenics-contact sweep hertz.toml --vary contact.0.friction_coefficient=0:0.5:6
  fenics-contact report results/hertz   # pictures and a page
  mpirun -n 4 fenics-contact run hertz.toml

fenics-contact COMMAND --help says more of each."""

RUN_EXAMPLES = """\
Examples:
  fenics-contact run scene.toml
  fenics-contact run scene.toml --out here --set load.0.pressure=5
  fenics-contact run scene.toml --set "load.0.traction=[-600, 0]" --set accuracy=1e-2
  fenics-contact run scene.toml --resume
  fenics-contact run scene.toml -- -snes_monitor -mat_mumps_icntl_14 80
  mpirun -n 4 fenics-contact run scene.toml"""

PETSC = """\
What follows -- is for PETSc, and wins over the program's choices, for this run alone. Options get
the prefix fenics_contact_ if they have not got it: -snes_max_it 50 (Newton's method), -ksp_view,
-mat_mumps_icntl_14 80 (the body's factorisation); with solver = "iterative" also -bulk_...
(multigrid) and -zone_... (MUMPS at the contacts). Options that nothing used are named at the end.
With the prefix they may also stand in the environment variable PETSC_OPTIONS."""

CHECK = """\
Reads scene and mesh as `run` does and says what would be modelled: energy terms, unknowns, solver,
memory, what may still move. It refuses what `run` would refuse, and writes nothing.

Examples:
  fenics-contact check scene.toml
  fenics-contact check scene.toml --set mesh.size=0.1"""

REPORT = """\
Makes pictures and a page, report.html, of what a run has left in its folder; of a sweep its page,
sweep.html, of a fit its page, fit.html, of cycles that wear theirs, wear.html. It needs the extra
`pictures` (pyvista, matplotlib), but no mesh, no scene and no MPI.

Example:
  fenics-contact report results/hertz"""

VERIFY = """\
Runs cases that have a formula or a published result: value, reference, source and error of each.

Examples:
  fenics-contact verify                 # all of them
  fenics-contact verify --quick         # about a minute
  fenics-contact verify hertz_sphere --json found.json
  fenics-contact verify --hard          # hard cases; minutes
  fenics-contact verify --errors        # error bars; a quarter of an hour"""

NEW = """\
Writes a scene with comments, and its mesh beside it, that runs as it is. Files that are there
already are left alone.

Examples:
  fenics-contact new --list
  fenics-contact new hertz
  fenics-contact new own --out mine/first.toml"""

SCHEMA = """\
Prints the JSON schema of a scene, from which editors complete keys, show what they mean and mark
what is wrong: VS Code with Even Better TOML, and others.

Example:
  fenics-contact schema > scene.schema.json   # a scene names it in its first line:
                                              # #:schema ./scene.schema.json"""

COMPLETION = """\
Prints a script by which a shell completes commands, options, scene files, keys after --set and
names of scenes to start from. It does not start the program, so it answers at once.

Examples:
  fenics-contact completion bash > ~/.local/share/bash-completion/completions/fenics-contact
  fenics-contact completion fish > ~/.config/fish/completions/fenics-contact.fish
  fenics-contact completion zsh > ~/.zfunc/_fenics-contact   # a folder of $fpath"""

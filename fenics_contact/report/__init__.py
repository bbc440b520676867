"""The page of a run and its pictures, from the run's files. No MPI, no FEniCSx."""

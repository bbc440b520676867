"""Tables of a scene that ask for more than its answer: accuracy, derivatives, modes, fatigue."""

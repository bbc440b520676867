"""Mass, and a step of motion as a problem of statics; the paper's friction is that of velocities.

The paper leaves motion out: "only a quasi-static assumption allowed the present simplification".
"""

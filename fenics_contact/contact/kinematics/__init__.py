"""Gap, jump and slip, against a rigid obstacle or against the surface of another body.

The paper's u_n - s and u_T.
"""

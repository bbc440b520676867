"""Values of a scene's numbers for which its run meets a measured curve, with their intervals.

Least squares by the Gauss-Newton method, with the exact derivatives of every load step. The
intervals hold the noise of the data and the errors of the discretisation.
"""

"""A scene under all combinations of values of its keys: which points, where, and what came out.

Points that need the same body are solved one after the other by one process, each of which is of
one rank; what they find goes to a journal at once, and to tables at the end.
"""

"""Whether contact and friction can hold the loads at all.

The paper's (2.4) and (2.5): |f(r)| < j(r) for all rigid motions r that the supports leave free.
"""

"""One body, many answers: a body that is made ready and condensed once, and asked again and again.

Only what is done to it changes from one answer to the next.
"""

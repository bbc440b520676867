"""Other answers to the same question: the paper's remarks after Step 4.

A critical coefficient of friction, and a search from other starts.
"""

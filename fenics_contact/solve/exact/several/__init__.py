"""Whether an answer is the only one, and which others there are.

``surely_unique_up_to`` needs W and the coefficients alone; ``all_answers`` finds them.
"""

from fenics_contact.solve.exact.several.all_answers import AllAnswers, all_answers
from fenics_contact.solve.exact.several.uniqueness import surely_unique_up_to

__all__ = ["AllAnswers", "all_answers", "surely_unique_up_to"]

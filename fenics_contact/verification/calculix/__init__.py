"""Inputs of CalculiX's own tests, said as scenes, beside the results that stand with them."""

"""``result.json``: every key with its type, its unit and what it means.

The writer fills these classes, the reader makes them of a file, pages and pictures take their
attributes, and the tables of ``docs/results.md`` are made from them. Attributes stand in the order
of the file. What has a default may be missing in files of earlier versions.
"""

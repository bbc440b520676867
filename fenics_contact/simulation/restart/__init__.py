"""The last accepted step as a file that any number of ranks can go on from."""

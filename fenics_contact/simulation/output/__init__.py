"""A run's folder: fields for ParaView, tables of steps and contacts, ``result.json``."""

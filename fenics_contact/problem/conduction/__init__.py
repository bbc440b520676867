"""Stationary conduction of heat, through bodies and across contacts that press more or less."""

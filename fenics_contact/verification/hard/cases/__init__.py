"""The hard cases, by topic."""

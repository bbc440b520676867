"""Natural frequencies of a body whose contacts are stuck, by the factorisation that is kept."""

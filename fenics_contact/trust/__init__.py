"""Whether to trust a result: checks of the physics, error bars, and other answers."""

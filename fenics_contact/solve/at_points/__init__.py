"""The condensed problem seen from its contact points: how far forces at them move them."""

"""Pictures of fretting: criteria of fatigue along contacts and below them."""

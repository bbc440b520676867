"""What a scene asks of its answer besides: what it depends on."""

"""What a deck says of the cloth."""

"""What a viewport shows, rendered on a thread of its own."""

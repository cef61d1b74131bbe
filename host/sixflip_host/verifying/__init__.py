"""What a board says it computed, held against the same capture solved here."""

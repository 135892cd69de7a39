"""Decks of frames that pound, drawn at random, and a campaign that compares AUTO with other methods."""
